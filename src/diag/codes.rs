//! All codes of diagnostics: the one place where they are declared. `docs/errors.md` is made from this table, and
//! `tests/mistakes.rs` compares the two, and the codes that stand in `src/` with the table.

use super::Severity::{self, Error, Execution, Warning};

/// A kind of diagnostic.
#[derive(Clone, Copy, Debug)]
pub struct Code {
    /// `E0301`; it keeps its meaning from version to version.
    pub code: &'static str,
    /// The most serious form in which it comes.
    pub severity: Severity,
    /// What it is called.
    pub title: &'static str,
    /// What it means or what to do, in one line.
    pub explanation: &'static str,
}

const fn row(
    code: &'static str,
    severity: Severity,
    title: &'static str,
    explanation: &'static str,
) -> Code {
    Code {
        code,
        severity,
        title,
        explanation,
    }
}

/// The sections of the page: a section goes from its code to the next section's.
const SECTIONS: &[(&str, &str)] = &[
    ("E0101", "Files and directives"),
    ("E0201", "Statements"),
    ("E0241", "Data and tables"),
    ("E0300", "Names, sets and indices"),
    ("E0328", "Output and options"),
    ("E0333", "Declarations and data"),
    ("E0350", "Models and solves"),
    ("E0370", "Figures and other output"),
    ("E0400", "Arithmetic"),
    ("E0410", "Generation and solution"),
    ("E0470", "Files that a run reads and writes"),
    ("E0480", "Aborts, figures and limits"),
];

/// One row per code, in order. Adding a code is adding a line.
#[rustfmt::skip]
pub const CODES: &[Code] = &[
    row("E0101", Error, "comment not closed", "`$onText`, `$onEcho`, `$onPut` or an inline comment has no end"),
    row("E0102", Error, "not UTF-8", "a file is not UTF-8 text; convert it, for example with `iconv`"),
    row("E0103", Error, "file not found", "a file is not there, cannot be read, or its name is missing"),
    row("E0104", Error, "file outside the allowed folders", "put the file beside the model, or allow its folder with `--allow-read`"),
    row("E0105", Error, "endless include", "a file includes itself, or files are included too deeply"),
    row("E0106", Error, "unbalanced `$ifThen`", "`$ifThen`, `$elseIf`, `$else` and `$endIf` do not fit together"),
    row("E0107", Error, "unknown directive", "there is no such directive, or its arguments are missing"),
    row("E0108", Error, "text too long", "the text is longer than 3 GB with all its includes, or a line longer than 4 MB with its `%name%` filled in"),
    row("E0109", Warning, "empty file", "nothing is declared and nothing is solved"),
    row("E0110", Error, "`$abort` or `$error`", "the message of the directive"),
    row("E0111", Error, "macro", "a macro cannot be defined or expanded"),
    row("E0112", Error, "library file", "`$libInclude` asks for a file of a GAMS installation"),
    row("E0113", Error, "other program", "`$call`, `$execute` and embedded code are refused"),
    row("E0114", Error, "condition of `$if`", "the condition cannot be read"),
    row("E0115", Error, "expression of `$eval`", "the expression cannot be evaluated"),
    row("E0116", Error, "`$goto`", "its `$label` is missing, or it does not end"),
    row("E0117", Warning, "`-D` without effect", "nothing in the text reads `%name%`"),

    row("E0201", Error, "missing semicolon", "`;` is missing before the next statement"),
    row("E0202", Error, "open parenthesis", "a parenthesis or a block is never closed"),
    row("E0203", Error, "open data", "data between slashes are never closed"),
    row("E0204", Error, "nested too deeply", "split the expression: give its parts names"),
    row("E0205", Error, "reserved word", "a word of the language is used as a name"),
    row("E0206", Error, "open quote", "a quote is not closed on its line"),
    row("E0207", Error, "stray parenthesis", "a parenthesis closes nothing"),
    row("E0208", Error, "`%name%` without a value", "set it with `$set`, or with `-D name=value`"),
    row("E0209", Error, "invalid sign, number or name", "names are made of letters, digits and `_`, and begin with a letter"),
    row("E0210", Error, "something else was expected", "the message lists what can stand there"),
    row("E0211", Error, "attribute of a definition", "an equation is defined by its name alone: `e(i)..`"),
    row("E0212", Error, "two operators in a row", "the second one needs parentheses: `a*(-b)`"),
    row("E0213", Error, "chain of relations", "write two comparisons joined by `and`, or two equations"),
    row("E0214", Error, "set expected", "sums and loops run over sets"),
    row("E0215", Error, "pair taken out of a model", "write `- equation` to take an equation out"),
    row("E0216", Error, "kind of equation", "`=x=`, `=c=` and `=b=` equations are not supported"),
    row("E0217", Error, "number behind `break`", "how many loops to leave is a whole number from 1 on"),
    row("E0218", Error, "incomplete `solve`", "a `solve` has one type and at most one direction"),
    row("E0219", Error, "misspelled keyword", "the message says which word is meant"),
    row("E0220", Error, "value or bound in a declaration", "values stand between slashes; bounds are assigned after the declaration"),
    row("E0221", Error, "equation without `..`", "two dots stand behind the equation's name and indices"),
    row("E0222", Error, "equation without a relation", "the sides of an equation are related by `=e=`, `=l=`, `=g=` or `=n=`"),
    row("E0223", Error, "comma in a declaration", "a comma or a blank is missing between names, or a comma is too many"),
    row("E0230", Error, "comment mark of another language", "a comment is a line with `*` in its first column; in `.blk` files also `//`"),
    row("E0231", Error, "statement of another language", "the message says how it is written here"),
    row("E0232", Error, "operator of another language", "the message says how it is written here"),
    row("E0233", Error, "`end` of a block", "blocks end with `);`"),
    row("E0234", Warning, "read as a text", "`variable x >= 0` and `x binary` declare a text, not a bound or kind; `/ a b c /` is one element with a text"),
    row("E0235", Error, "sum of another language", "`sum(i, term)`, `sum((i,j), term)`"),
    row("E0236", Error, "head of a block", "`loop(i, … );`, `for(k = 1 to 5, … );`, `if(c, … );`, `while(c, … );`"),

    row("E0241", Error, "open group of labels", "`)` is missing"),
    row("E0242", Error, "open quote in data", "a quote is not closed on its line"),
    row("E0243", Error, "unreadable data", "a label, a value or a number was expected"),
    row("E0244", Error, "groups nested too deeply", "write the records one by one"),
    row("E0245", Error, "not a number", "numbers look like `12`, `-3.5`, `1.5e-3`"),
    row("E0246", Error, "`undf` in data", "it may be written only after `$onUndf`; `na` is a missing value"),
    row("E0247", Error, "constant expression", "it cannot be evaluated; numbers, functions, `card(set)` and scalars with data can stand in it"),
    row("E0248", Error, "comma in data", "a comma is missing between records, or one is too many"),
    row("E0250", Error, "value under no column", "a value stands under a part of its column's label"),
    row("E0251", Error, "value under two columns", "move it under one of them"),
    row("E0252", Error, "row label under a column", "the label of a row reaches under the first column"),
    row("E0253", Error, "two values under one column", "a column takes one value per row"),
    row("E0254", Error, "table without rows", "a line with `+` stands below the rows of the columns before"),

    row("E0300", Error, "too many errors", "the rest of the text was not checked"),
    row("E0301", Error, "unknown name", "names are declared above the place where they are used"),
    row("E0302", Error, "not a set", "an index position takes a set that is bound, a quoted label, or a lag"),
    row("E0303", Error, "index not bound", "sum over the index, or add it to the domain of the equation or assignment"),
    row("E0304", Error, "wrong number of indices", "a symbol has as many indices as its declaration says"),
    row("E0305", Error, "index bound twice", "use an alias for the inner index"),
    row("E0306", Error, "set does not fit", "an index position takes the set that it was declared over, or a subset"),
    row("E0307", Error, "not an index", "an index is a set, a quoted label, or a lag such as `t-1`"),
    row("E0308", Error, "label not in the set", "add the label to the set, or correct it"),
    row("E0309", Error, "lag or order", "lags, leads and `ord` need one ordered set"),
    row("E0310", Error, "variable without attribute", "outside equations a variable or equation needs `.l`, `.m`, `.lo` or `.up`"),
    row("E0311", Error, "variable in a condition", "conditions use data only; `x.l` is the level of the last solve"),
    row("E0312", Error, "text in an expression", "a number is expected"),
    row("E0313", Error, "`++` or `--` outside an index", "circular lags stand between an index and a number"),
    row("E0314", Error, "unknown attribute", "the symbol has no such attribute, or it cannot be read or assigned"),
    row("E0315", Error, "not a number", "a model, file or figure stands where a number is expected"),
    row("E0316", Error, "number of arguments", "a function is called with too many or too few arguments"),
    row("E0317", Error, "wrong argument", "`ord`, `card` and `sameas` take sets"),
    row("E0318", Error, "variable as an argument", "this argument must be data"),
    row("E0319", Error, "no values", "a symbol is used before it gets data, is assigned or solved for"),
    row("E0320", Error, "domain changed", "a set that is a domain cannot be assigned; declare a subset"),
    row("E0321", Error, "`for` over a set", "`for` counts with a scalar; `loop` runs over a set"),
    row("E0322", Warning, "other program", "`execute`, embedded code that gives nothing back, and exports to other programs are passed over"),
    row("E0323", Error, "not a figure", "`draw` takes a figure and a file name in quotes"),
    row("E0324", Error, "declaration in a block", "declarations and equations stand outside loops"),
    row("E0325", Error, "not assignable", "only parameters, sets, and attributes are assigned"),
    row("E0326", Error, "not an equation", "an equation is declared before it is defined"),
    row("E0327", Error, "equation defined twice", "give the second one another name"),

    row("E0328", Error, "indices in `display`", "`display` takes whole symbols"),
    row("E0329", Error, "option", "there is no such option, or it does not take this value"),
    row("E0330", Error, "option without a value", "write `option name = value;`"),
    row("E0331", Error, "projection", "only sets and parameters are projected, to symbols over some of their indices"),
    row("E0332", Error, "unknown element of a figure", "the message lists the elements"),

    row("E0333", Error, "declared twice", "a name belongs to one symbol; capitals do not distinguish names"),
    row("E0334", Error, "domain of several positions", "a domain is one-dimensional"),
    row("E0335", Error, "declared over other sets", "a second declaration repeats the domain of the first"),
    row("E0336", Error, "too many positions", "a symbol has at most 20 indices, a scalar none"),
    row("E0337", Error, "`alias` without a set", "`alias` gives a set another name"),
    row("E0338", Error, "wrong item in a model", "a model is made of equations, and pairs `equation.variable`"),
    row("E0339", Error, "dynamic set as a domain", "a set that is assigned cannot be a domain"),
    row("E0340", Error, "second data statement", "a symbol gets data once, except under `$onMulti`"),
    row("E0341", Error, "record given twice", "a label or record stands twice in the data of one symbol"),
    row("E0342", Error, "second element of a singleton", "a singleton set has one element"),
    row("E0343", Error, "too many records", "a range or group stands for more records than memory holds"),
    row("E0344", Error, "not a range", "the labels of a range differ in one number: `t1*t10`"),
    row("E0345", Error, "number expected in data", "a label needs a number behind it"),
    row("E0346", Error, "table of one dimension", "a table has rows and columns: at least two indices"),
    row("E0347", Warning, "unequal lists", "`:` matches one by one, and one side is longer"),
    row("E0348", Error, "kind of a variable", "a variable has one kind from its first use on"),
    row("E0349", Error, "unknown solver", "`bmod --version` lists the solvers"),

    row("E0350", Error, "not a model", "`solve` takes a model: `model m / all /;`"),
    row("E0351", Error, "unknown problem type", "the message lists the types"),
    row("E0352", Error, "`emp`", "this problem type is not supported"),
    row("E0353", Error, "model without equations", "list equations in it: `model m / all /;`"),
    row("E0354", Error, "objective not expected", "`mcp` and `cns` have no objective"),
    row("E0355", Error, "objective missing", "write `minimizing z` or `maximizing z`"),
    row("E0356", Error, "equation not defined", "an equation of the model is declared but not defined"),
    row("E0357", Error, "objective not a variable", "an equation defines the objective variable"),
    row("E0358", Error, "objective indexed", "the objective is a single free variable"),
    row("E0359", Error, "objective restricted in sign", "the objective must be a free variable"),
    row("E0360", Error, "objective in no equation", "an equation of the model defines the objective"),
    row("E0361", Error, "not linear", "the problem type takes linear equations only"),
    row("E0362", Error, "not smooth", "the problem type takes smooth functions only"),
    row("E0363", Error, "discrete variable", "the problem type takes continuous variables only"),
    row("E0364", Error, "inequality without partner", "in `mcp` an inequality is paired with a variable"),
    row("E0365", Error, "pair of different dimension", "an equation and its variable have the same indices"),
    row("E0366", Error, "pair over different sets", "an equation and its variable run over the same sets in the same order"),
    row("E0367", Error, "paired twice", "an equation has one partner"),
    row("E0368", Error, "partner in no equation", "the variable of a pair must stand in the model"),
    row("E0369", Error, "index of a loop in an equation", "loop over an alias of the set around the solve"),

    row("E0370", Error, "unknown argument of a figure", "the message lists the arguments"),
    row("E0371", Error, "text for a number", "this argument of a figure is a number"),
    row("E0372", Execution, "not a colour", "colours are names or `#rrggbb`"),
    row("E0373", Error, "argument of a figure missing", "the message names it"),
    row("E0374", Error, "`put` without a file", "declare `file f / 'name.txt' /;` and write `put f;` first"),
    row("E0375", Error, "membership as a number", "`1$(…)` makes a number of a membership"),

    row("E0376", Error, "data of another kind", "members are given to sets, numbers to parameters"),
    row("E0377", Error, "data of another shape", "data from outside have as many labels as the symbol has indices"),
    row("E0378", Warning, "membership assigned", "`p(t) = t` gives 1 for every element; `ord(t)` is its position, `t.val` its number"),
    row("E0379", Warning, "condition without parentheses", "`a $ b > c` compares `a $ b` with `c`; write `a $ (b > c)`"),
    row("E0380", Warning, "alias of nothing", "`alias(i, j)` makes `j` another name of the set `i`"),

    row("E0400", Execution, "not a count", "a position, width or count is a finite number"),
    row("E0401", Execution, "division by zero", "guard it with a condition"),
    row("E0402", Execution, "infinity times zero", "guard the product with a condition"),
    row("E0403", Execution, "function without a value", "the argument lies outside the function's domain, such as `log(0)`"),
    row("E0404", Execution, "overflow", "the result is too large for a number"),
    row("E0405", Execution, "label is not a number", "`.val` and `.tval` need labels that are numbers"),
    row("E0406", Execution, "step of `for`", "the step is positive; `downto` counts down"),
    row("E0407", Execution, "elements of a singleton", "several were assigned; the first is kept"),
    row("E0408", Execution, "acronym in a computation", "acronyms can be assigned and compared only"),
    row("E0409", Execution, "too few numbers of orders", "`option p > s` needs n! elements of the first index of `p` for n elements of `s`"),

    row("E0410", Execution, "empty row", "a row without variables cannot hold"),
    row("E0411", Execution, "coefficient not finite", "look for `inf`, `na` or `undf` in the data of the equation"),
    row("E0412", Execution, "column matched twice", "a column is matched with two rows"),
    row("E0413", Execution, "impossible bounds", "a bound, level or scale is not a number, or the lower bound lies above the upper"),
    row("E0414", Execution, "empty row with a partner", "a row in which no variable is left has a partner that is not fixed"),
    row("E0415", Execution, "partner in no row", "the partner of a row stands in no row"),
    row("E0416", Warning, "equation with a bounded partner", "`=e=` need not hold where its partner is at a bound"),
    row("E0417", Warning, "too many equations", "equations stand in fewer variables than there are equations"),
    row("E0418", Warning, "too many variables", "free variables stand in fewer rows than there are variables"),
    row("E0422", Execution, "model cannot be solved", "rows and columns do not match, or functions have no value at the start"),
    row("E0423", Execution, "option of a model", "`m.optcr` and its kind have the ranges that `bmod help options language` lists"),
    row("E0424", Execution, "scenarios", "the dictionary of the scenarios cannot be used"),
    row("E0426", Execution, "option file", "an option file, or a line of it, is not used"),
    row("E0430", Execution, "no solve to derive from", "the model that is meant is not solved, or there is no solve with this number"),
    row("E0431", Execution, "no linear dual", "no objective, discrete variables, or equations that are not linear"),
    row("E0432", Execution, "no optimality conditions", "no objective, kinks, or a function whose derivative the language lacks"),
    row("E0433", Execution, "no ranges", "they belong to a linear program that was solved to an optimum"),

    row("E0434", Warning, "a listing needs a solve", "`bmod list` solves nothing: what depends on levels, marginals or statuses may be another model in a run"),
    row("E0470", Execution, "file not written", "the folder or the disk does not allow it"),
    row("E0471", Execution, "file not read", "the file cannot be opened"),
    row("E0472", Execution, "no open file", "`put` needs a file: `put f;`"),
    row("E0473", Warning, "text does not fit", "a number, line or page of a `put` file is too small"),
    row("E0474", Warning, "`put_utility`", "this command is not carried out"),
    row("E0475", Execution, "nothing to exchange", "a symbol with data, and a file, must be named"),
    row("E0476", Warning, "file kept from the disk", "`$echo` or `$gdxOut` names a file outside the output folder"),
    row("E0477", Execution, "symbol not in the file", "the message names the nearest"),
    row("E0478", Execution, "data file", "its content cannot be loaded; nothing was changed"),
    row("E0479", Execution, "label of a data file", "it is not in the domain"),

    row("E0480", Execution, "`abort`", "the model stopped itself"),
    row("E0481", Execution, "figure not drawn", "its file or format cannot be written"),
    row("E0482", Warning, "value not drawn", "a value of a figure is not a finite number"),
    row("E0483", Execution, "argument of a figure", "its value cannot be used"),
    row("E0484", Warning, "empty figure", "a figure with nothing to draw is an empty page; a condition may leave nothing"),
    row("E0485", Execution, "`execError` assigned", "a run with more errors than `maxExecError` fails"),
    row("E0490", Execution, "time limit", "raise it with `--time-limit`"),
    row("E0491", Execution, "memory limit", "raise it with `--max-memory`, or keep the sets sparse"),
    row("E0492", Execution, "interrupted", "the run was stopped by Ctrl-C, or by the system; run it again"),
    row("E0499", Execution, "defect of bmod", "something went wrong inside of bmod; please report it with the model"),
];

/// The row of a code.
pub fn find(code: &str) -> Option<&'static Code> {
    CODES
        .binary_search_by(|c| c.code.cmp(code))
        .ok()
        .map(|k| &CODES[k])
}

/// The page `docs/errors.md`.
pub fn page() -> String {
    let mut out = String::from(
        "# Codes of diagnostics\n\n\
         Every diagnostic has a code that keeps its meaning from version to version, a place in the text, a message,\n\
         and, where it can be told, how to fix it. An *error* is found before anything runs (exit status 2), an\n\
         *execution error* while the model runs (exit status 3); a *warning* changes nothing. This page is made from the\n\
         table in `src/diag/codes.rs`.\n",
    );
    for (k, (from, title)) in SECTIONS.iter().enumerate() {
        let to = SECTIONS.get(k + 1).map_or("F", |s| s.0);
        out.push_str(&format!(
            "\n## {title}\n\n| code | | meaning |\n| --- | --- | --- |\n"
        ));
        for c in CODES.iter().filter(|c| (*from..to).contains(&c.code)) {
            let severity = match c.severity {
                Warning => "warning",
                Error => "error",
                Execution => "execution error",
            };
            out.push_str(&format!(
                "| {} | {severity} | **{}**: {} |\n",
                c.code, c.title, c.explanation
            ));
        }
    }
    out
}
