"""Data of every wrong kind, drawn at random: an exception that names the symbol, or right data; never a crash."""

import datetime
import decimal
import math
import random
import warnings

import numpy as np
import pandas as pd
import pytest

import bmod

TEXT = """
Set i / a, b, c /, j / x, y /, arc(i,j), k;
Parameter p(i) / a 1 /, q(i,j), u(*), w(k<);  Scalar s / 2 /;
Positive variable v(i);  Variable z;  Equations e, f(i);
e..  z =e= sum(i, p(i)*v(i)) + s;  f(i)..  v(i) =g= 1;
Model m / all /;  solve m using lp minimizing z;
"""
NAMES = ["i", "j", "arc", "k", "p", "q", "u", "w", "s", "v", "m", "nothing", "", 3, None]

LABELS = ["a", "b", "c", "x", "y", "A", "a ", "new", "", "ä", "a'b\"c", "x" * 100, 1, 1.0, 2.5, True, None, math.nan, ("a", "x"), b"a",
          pd.NA, pd.NaT, pd.Timestamp("2026-01-01"), 10**30, -1, frozenset()]
VALUES = [0, 1, -2.5, 1e300, math.inf, -math.inf, math.nan, True, None, "1", "", 1j, 10**400, decimal.Decimal("1.5"), pd.NA, pd.NaT,
          np.float32(1.5), np.int64(3), np.datetime64("2026-01-01"), datetime.date(2026, 1, 1), [1], {}, object(), lambda: 0]


def draw(r):
    """Data of some kind."""
    many = r.choice([0, 1, 2, 3, 7])
    label = lambda: r.choice(LABELS[: r.choice([3, 8, len(LABELS)])])  # noqa: E731
    value = lambda: r.choice(VALUES[: r.choice([3, 6, len(VALUES)])])  # noqa: E731
    key = lambda: r.choice([label, lambda: (label(), label()), lambda: tuple(label() for _ in range(r.choice([0, 1, 3])))])()  # noqa: E731
    keys, values = [key() for _ in range(many)], [value() for _ in range(many)]
    kind = r.randrange(16)
    if kind == 0:
        return value()
    if kind == 1:
        return dict(zip(keys, values))
    if kind == 2:
        return pd.Series(values, index=[label() for _ in keys], dtype=object)
    if kind == 3:
        return pd.Series([float(n) for n in range(many)], index=pd.Index([str(label()) for _ in keys]))
    if kind == 4:
        index = pd.MultiIndex.from_arrays([[label() for _ in keys], [label() for _ in keys]], names=r.choice([None, ["i", "j"], ["j", "i"], ["i", "i"]]))
        return pd.Series(values, index=index, dtype=object)
    if kind == 5:
        return pd.DataFrame([[value() for _ in range(2)] for _ in keys], index=[label() for _ in keys], columns=[label(), label()], dtype=object)
    if kind == 6:
        return pd.DataFrame({"i": [label() for _ in keys], "value": pd.Series(values, dtype=object)})
    if kind == 7:
        return np.array(values, dtype=object)
    if kind == 8:
        return np.zeros(r.choice([(), (0,), (2,), (3,), (3, 2), (2, 3), (3, 2, 1), (1,) * 12]), dtype=r.choice([float, int, bool, np.float16, "U3", "M8[s]", complex]))
    if kind == 9:
        return keys
    if kind == 10:
        return tuple(values)
    if kind == 11:
        return set(k for k in keys if not isinstance(k, (list, dict)))
    if kind == 12:
        return pd.array(r.choice([[1, None, 3], [1.5, 2.5, 3.5]]), dtype=r.choice(["Float64", "object"]))
    if kind == 13:
        return pd.Categorical([str(label()) for _ in keys])
    if kind == 14:
        return (label() for _ in keys)
    return r.choice([pd.DataFrame(), pd.Series(dtype=float), {}, [], (), "", "a", b"a", range(3), iter([]), type, bmod])


@pytest.mark.parametrize("seed", range(40))
def test_anything(seed):
    r = random.Random(seed)
    m = bmod.Model.from_text(TEXT)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(40):
            name = r.choice(NAMES)
            data = draw(r)
            try:
                m[name] = data
            except bmod.UnknownSymbolError:
                assert name not in m
            except bmod.DataError as e:
                assert f"`{name}`" in str(e), (name, data, e)
            else:
                # What was taken is there, or the run says what is wrong with it.
                result = m.run(check=False)
                if result.ok:
                    assert m[name] is not None
                else:
                    # A set without a member that the text's own data have is wrong at those data, infinity in its row.
                    elsewhere = m.symbols[name].kind == "set" or "finite" in result.messages
                    assert elsewhere or f"`{name}" in result.messages, (name, data, result.messages)
                    del m[name]
            if r.random() < 0.2 and isinstance(name, str) and name in m and m.symbols[name].kind in ("set", "parameter"):
                del m[name]
    for name in list(m):
        if m.symbols[name].kind in ("set", "parameter"):
            del m[name]
    assert m.run().objective == pytest.approx(3)


def test_huge():
    m = bmod.Model.from_text(TEXT)
    with pytest.raises(bmod.DataError, match="`p`.*shape"):
        m["p"] = np.zeros((3000, 1000))
    with pytest.raises(bmod.DataError, match="`p`.*twice"):
        m["p"] = pd.Series(1.0, index=["a"] * 500_000)
    m["u"] = pd.Series(1.0, index=np.arange(500_000))
    assert len(m.run()["u"]) == 500_000


def test_exceptions_in_callbacks_and_outside():
    m = bmod.Model.from_text(TEXT)

    class Odd(BaseException):
        pass

    def fails(*_):
        raise Odd("from the callback")

    with pytest.raises(Odd):
        m.run(on_print=fails)
    with pytest.raises(TypeError):
        m.run(on_print=3)
    with pytest.raises((TypeError, ValueError, OverflowError)):
        m.run(max_memory=-1)
    for wrong in ({"nosuch": 1}, {"lp": "nosuch"}, {"": ""}):
        r = m.run(options=wrong, check=False)
        assert r.ok or r.diagnostics
    assert m.run().objective == pytest.approx(3)


def test_an_array_after_a_set_in_another_order():
    m = bmod.Model.from_text("set u / a, b, c /; set i; parameter p(i);")
    m["i"] = ["c", "a"]
    with pytest.raises(bmod.DataError, match="order"):
        m["p"] = [10, 20]
    m["p"] = {"c": 10, "a": 20}
    assert dict(m["p"]) == {"a": 20, "c": 10}


def test_a_model_that_is_gone():
    m = bmod.Model.from_text(TEXT)
    r = m.run()
    x = r["v"]
    del m, r
    assert x.level["a"] == 1
    with pytest.raises(AttributeError):
        bmod.Model.__new__(bmod.Model).run()
