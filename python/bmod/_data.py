"""Data of Python, NumPy and pandas as columns of labels and numbers, and back."""

from __future__ import annotations

import numbers
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Callable, List, Optional, Tuple

from ._errors import DataError

if TYPE_CHECKING:
    import numpy as np

#: Labels of an index position, each once, and their codes per record.
Key = Tuple[List[str], bytes]


def text_of(label: Any) -> str:
    """A label as text: 1 and 1.0 are `1`."""
    if isinstance(label, str):
        return label
    if isinstance(label, bool) or label is None:
        raise TypeError(f"{label!r} is not a label")
    if isinstance(label, numbers.Real):
        value = float(label)
        if value != value:
            raise TypeError("NaN is not a label")
        return str(int(value)) if value.is_integer() else repr(value)
    return str(label)


def _keys(name: str, columns: List[Any]) -> List[Key]:
    """Columns of labels as codes."""
    import numpy as np
    import pandas as pd

    out = []
    for column in columns:
        if isinstance(column, tuple):
            codes, labels = column
        else:
            try:
                codes, labels = pd.factorize(pd.Index(column), use_na_sentinel=True)
            except TypeError:  # what cannot be compared or has no hash
                odd = next((v for v in column if isinstance(v, (list, dict, set))), column)
                hint = "; several labels are a tuple" if isinstance(odd, list) else ""
                raise DataError(f"`{name}`: {odd!r} is not a label{hint}") from None
        if len(codes) and codes.min() < 0:
            raise DataError(f"`{name}`: record {int(codes.argmin()) + 1} has no label")
        try:
            texts = [text_of(label) for label in labels]
        except TypeError as e:
            raise DataError(f"`{name}`: {e}") from None
        out.append((texts, codes.astype(np.int32).tobytes()))
    return out


def _numbers(name: str, values: Any) -> "np.ndarray[Any, Any]":
    import numpy as np

    if hasattr(values, "array") and hasattr(values.dtype, "na_value") and values.dtype.kind in "biuf":
        values = values.to_numpy(dtype="float64", na_value=np.nan)  # pandas' own numbers, with NA
    array = np.asarray(values)
    if array.dtype.kind not in "biuf":
        for k, v in enumerate(array.ravel() if isinstance(values, np.ndarray) else values):
            if not isinstance(v, numbers.Real):
                raise DataError(f"`{name}`: value {k + 1}, {v!r}, is not a number")
    try:
        return np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as e:
        raise DataError(f"`{name}`: {e}") from None


def _frame(name: str, data: Any, domain: Optional[List[str]]) -> Tuple[List[Any], Any]:
    """A DataFrame: an index and one column, a table of two or more dimensions, or columns of labels and `value`."""
    import pandas as pd

    columns = list(data.columns)
    if not data.columns.is_unique:
        raise DataError(f"`{name}`: two columns have the same name")
    if columns == ["value"] and domain and isinstance(data.index, pd.RangeIndex):
        raise DataError(f"`{name}` has {len(domain)} index positions; the DataFrame has no labels beside `value`")
    if columns and columns[-1] == "value" and isinstance(data.index, pd.RangeIndex):
        return _ordered([data[c] for c in columns[:-1]], columns[:-1], domain), data["value"]
    if _is_list(data, domain):
        return _ordered([data[c] for c in columns[:-1]], columns[:-1], domain), data[columns[-1]]
    if len(columns) == 1 and (domain is None or data.index.nlevels == len(domain)):
        return _ordered(_levels(data.index), data.index.names, domain), data[columns[0]]
    # A table: its columns are the last positions. Empty cells are no records.
    rows, wide = _levels(data.index), _levels(data.columns)
    values = _numbers(name, data.to_numpy()).ravel()
    full = values == values
    at_row = pd.RangeIndex(len(data)).repeat(len(columns))[full]
    at_column = _tile(len(columns), len(data))[full]
    keys = [_take(level, at_row) for level in rows] + [_take(level, at_column) for level in wide]
    return _ordered(keys, [*data.index.names, *data.columns.names], domain), values[full]


def _is_list(data: Any, domain: Optional[List[str]]) -> bool:
    """Whether the columns are labels and, last, numbers, whatever that one is called; a table has numbers in all of them."""
    import pandas as pd

    if not domain or len(data.columns) != len(domain) + 1 or not isinstance(data.index, pd.RangeIndex):
        return False
    *labels, values = (data.iloc[:, k] for k in range(len(data.columns)))
    words = any(pd.api.types.infer_dtype(c) in ("string", "categorical") for c in labels)
    named = sorted(str(c).lower() for c in data.columns[:-1]) == sorted(s.lower() for s in domain)
    return (words or named) and pd.api.types.is_numeric_dtype(values)


def _tile(count: int, times: int) -> Any:
    import numpy as np

    return np.tile(np.arange(count), times)


def _take(level: Any, at: Any) -> Any:
    """Records of a position: of a column of labels, or of codes with their labels."""
    return (level[0][at], level[1]) if isinstance(level, tuple) else level.take(at)


def _ordered(columns: List[Any], names: Iterable[Any], domain: Optional[List[str]]) -> List[Any]:
    """Positions in the order of the symbol's index sets, where the data name all of them; else as they are."""
    named = [str(n).lower() for n in names]
    wanted = [s.lower() for s in domain or ()]
    if len(set(wanted)) == len(wanted) and sorted(named) == sorted(wanted):
        return [columns[named.index(s)] for s in wanted]
    return columns


def _levels(index: Any) -> List[Any]:
    """The labels of each position; of an index of several levels the codes that it has, and their labels."""
    import pandas as pd

    if not isinstance(index, pd.MultiIndex):
        return [index]
    index = index.remove_unused_levels()
    return list(zip((np_codes(c) for c in index.codes), index.levels))


def np_codes(codes: Any) -> Any:
    """Codes as NumPy has them."""
    import numpy as np

    return np.asarray(codes)


def looks_like_values(data: Any) -> bool:
    """Whether data look like a parameter's, for a text that does not compile."""
    if isinstance(data, Mapping):
        return all(not isinstance(v, str) for v in data.values())
    return not isinstance(data, (list, tuple, set))


def parameter(
    name: str,
    data: Any,
    domain: Optional[List[str]],
    members: Callable[[str], List[str]],
) -> Tuple[List[Key], bytes]:
    """Data for a parameter. `domain` has the index sets where the model is known; `members` gives a set's labels."""
    import numpy as np
    import pandas as pd

    columns: List[Any]
    values: Any
    dimension = None if domain is None else len(domain)
    if hasattr(data, "to_series") and hasattr(data, "dims"):
        data = data.to_series() if data.dims else data.item()  # xarray
    if isinstance(data, numbers.Real) or (np.ndim(data) == 0 and isinstance(data, np.ndarray)):
        columns, values = [], [data if isinstance(data, numbers.Real) else data.item()]
    elif isinstance(data, pd.Series):
        columns, values = _ordered(_levels(data.index), data.index.names, domain), data
    elif isinstance(data, pd.DataFrame):
        columns, values = _frame(name, data, domain)
    elif isinstance(data, Mapping):
        keys = [k if isinstance(k, tuple) else (k,) for k in data]
        wide = {len(k) for k in keys}
        if len(wide) > 1:
            raise DataError(f"`{name}`: keys have {min(wide)} and {max(wide)} labels")
        columns = [list(c) for c in zip(*keys)] if keys else [[] for _ in range(dimension or 1)]
        values = list(data.values())
    elif isinstance(data, np.ndarray) or (isinstance(data, (list, tuple)) and not isinstance(data, str)):
        array = _numbers(name, data)
        if domain is None or "*" in domain:
            raise DataError(f"`{name}`: an array needs index sets that the model declares; give a dict or a Series")
        shape = tuple(len(members(s)) for s in domain)
        if array.shape != shape:
            sets = ", ".join(f"{s}: {n}" for s, n in zip(domain, shape))
            raise DataError(f"`{name}`: the array has the shape {array.shape}; its sets have {shape} members ({sets})")
        index = pd.MultiIndex.from_product([members(s) for s in domain])
        columns, values = _levels(index), array.ravel()
    else:
        raise DataError(
            f"`{name}`: {type(data).__name__} is not a number, dict, list, Series, DataFrame or array"
        )
    if dimension is not None and len(columns) != dimension:
        given = "a number was given" if not columns else f"the data have {len(columns)}"
        raise DataError(f"`{name}` has {dimension} index positions; {given}")
    return _keys(name, columns), _numbers(name, values).tobytes()


def members(
    name: str, data: Any, dimension: Optional[int]
) -> Tuple[List[Key], Optional[List[str]]]:
    """Members of a set: a list of labels or tuples, or a dict or a Series with their texts."""
    import pandas as pd

    columns: List[Any]
    texts = None
    if isinstance(data, Mapping):
        texts = ["" if t is None else str(t) for t in data.values()]
        data = list(data)
    if isinstance(data, str) or not isinstance(data, Iterable):
        raise DataError(f"`{name}`: a set takes a list of labels, not {data!r}")
    if isinstance(data, pd.DataFrame):
        columns = [data[c] for c in data.columns]
    elif isinstance(data, pd.Series) and not pd.api.types.is_integer_dtype(data.index):
        return _described(name, data, dimension)
    elif isinstance(data, (pd.Index, pd.Series)):
        columns = _levels(data) if isinstance(data, pd.Index) else [data]
    else:
        keys = [k if isinstance(k, tuple) else (k,) for k in data]
        wide = {len(k) for k in keys} or {dimension or 1}
        if len(wide) > 1:
            raise DataError(f"`{name}`: members have {min(wide)} and {max(wide)} labels")
        columns = [list(c) for c in zip(*keys)] if keys else [[] for _ in range(wide.pop())]
    if dimension is not None and len(columns) != dimension:
        raise DataError(f"`{name}` has {dimension} index positions; its members have {len(columns)}")
    return _keys(name, columns), texts


def _described(name: str, data: Any, dimension: Optional[int]) -> Tuple[List[Key], Optional[List[str]]]:
    """A Series whose index has the labels: its values are texts, or tell which labels are members."""
    import pandas as pd

    kind = pd.api.types.infer_dtype(data, skipna=True)
    if kind == "boolean":
        return members(name, data.index[data.fillna(False).astype(bool)], dimension)
    if kind not in ("string", "empty"):
        raise DataError(
            f"`{name}`: the values of a Series with labels are texts of the members, or booleans that tell which they are, "
            f"not {data.dtype}; give `s.index` for its labels alone"
        )
    keys, _ = members(name, data.index, dimension)
    return keys, ["" if t else v for v, t in zip(data, data.isna())]


def index(keys: List[Tuple[List[str], bytearray]], names: List[str]) -> Any:
    """The pandas index of records: unique labels and codes, no copy per record."""
    import numpy as np
    import pandas as pd

    arrays = [np.frombuffer(codes, dtype=np.int32) for _, codes in keys]
    if len(keys) == 1:
        labels = np.array(keys[0][0], dtype=object)
        return pd.Index(labels.take(arrays[0]) if len(labels) else labels, name=names[0])
    return pd.MultiIndex(
        levels=[pd.Index(labels, dtype=object) for labels, _ in keys],  # type: ignore[misc]  # the stubs forbid an Index
        codes=arrays,  # type: ignore[arg-type]  # and arrays
        names=names,
        verify_integrity=False,
    )
