//! The words of the language with what they mean, in a line each: what is hovered over and what is proposed.

/// A word, how it is written, what it means.
pub struct Entry {
    /// The word, lower case.
    pub word: &'static str,
    /// How it is written.
    pub form: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

const fn e(word: &'static str, form: &'static str, meaning: &'static str) -> Entry {
    Entry {
        word,
        form,
        meaning,
    }
}

/// Words that begin a statement.
#[rustfmt::skip]
pub const STATEMENTS: &[Entry] = &[
    e("set", "Set i 'text' / a, b, c /;", "Declares sets and their elements."),
    e("singleton", "Singleton set s(i);", "Declares a set of at most one element."),
    e("alias", "Alias (i,j);", "Gives a set another name."),
    e("parameter", "Parameter p(i) 'text' / a 1, b 2 /;", "Declares data over sets, and their values."),
    e("scalar", "Scalar s / 5 /;", "Declares a number."),
    e("table", "Table d(i,j)\n      b1  b2\n  a1   1   2;", "Declares data, and their values in rows and columns."),
    e("variable", "Variable z;", "Declares unknowns, free unless a kind stands before: `positive`, `negative`, `binary`, `integer`, `semicont`, `semiint`, `sos1`, `sos2`."),
    e("positive", "Positive variable x(i);", "Declares unknowns of at least 0."),
    e("nonnegative", "Nonnegative variable x(i);", "Declares unknowns of at least 0."),
    e("negative", "Negative variable x(i);", "Declares unknowns of at most 0."),
    e("free", "Free variable x(i);", "Declares unknowns without bounds."),
    e("binary", "Binary variable x(i);", "Declares unknowns that are 0 or 1."),
    e("integer", "Integer variable x(i);", "Declares whole unknowns of at least 0."),
    e("semicont", "Semicont variable x(i);", "Declares unknowns that are 0 or between their bounds."),
    e("semiint", "Semiint variable x(i);", "Declares unknowns that are 0 or whole and between their bounds."),
    e("sos1", "Sos1 variable x(i);", "Declares sets of unknowns, one of which is not 0 at most."),
    e("sos2", "Sos2 variable x(i);", "Declares sets of unknowns, two neighbours of which are not 0 at most."),
    e("equation", "Equation e(i) 'text';", "Declares equations; each is defined by `e(i).. left =e= right;`."),
    e("model", "Model m / all /;", "Names the equations that are solved together; for `mcp` pairs `equation.variable`."),
    e("acronym", "Acronym low, high;", "Declares words that stand for values."),
    e("file", "File f / out.txt /;", "Declares a file that `put` writes to."),
    e("solve", "solve m using lp minimizing z;", "Solves a model; what follows sees the answer as `x.l`, `e.m`."),
    e("display", "display p, x.l;", "Shows data and levels."),
    e("abort", "abort$(c) 'text', p;", "Ends the run, under a condition perhaps, and shows what is listed."),
    e("option", "option decimals = 4;", "Sets an option of the run or of a solver."),
    e("loop", "loop(i,\n   …\n);", "Carries statements out for each element."),
    e("while", "while(c,\n   …\n);", "Carries statements out as long as a condition holds."),
    e("for", "for(k = 1 to 10,\n   …\n);", "Carries statements out for successive numbers."),
    e("repeat", "repeat(\n   …\nuntil c);", "Carries statements out until a condition holds."),
    e("if", "if(c,\n   …\nelse\n   …\n);", "Carries statements out under a condition."),
    e("else", "else", "What is carried out otherwise."),
    e("elseif", "elseif c,", "Another condition."),
    e("until", "until c", "Ends a `repeat`."),
    e("break", "break;", "Leaves a loop."),
    e("continue", "continue;", "Goes on with the next element of a loop."),
    e("put", "put f 'text' x.l(i):10:4 /;", "Writes to a file."),
    e("putclose", "putclose f;", "Closes a file that `put` writes to."),
    e("figure", "figure f 'title' {\n   polyline(i) x = a(i), y = b(i);\n};", "Declares a figure: elements over sets, with data, levels or marginals."),
    e("draw", "draw f 'f.svg';", "Draws a figure as SVG or PNG."),
    e("execute_unload", "execute_unload 'out.csv', x;", "Writes data to a file: GDX, CSV or JSON."),
    e("execute_load", "execute_load 'in.gdx', p;", "Reads data from a file while the model runs."),
    e("execute_loadpoint", "execute_loadpoint 'point.gdx';", "Takes levels and marginals from a file."),
];

/// Words inside of statements.
#[rustfmt::skip]
pub const INNER: &[Entry] = &[
    e("sum", "sum((i,j)$c, e)", "The sum over elements."),
    e("prod", "prod(i, e)", "The product over elements."),
    e("smin", "smin(i, e)", "The least over elements."),
    e("smax", "smax(i, e)", "The greatest over elements."),
    e("sand", "sand(i, e)", "Whether it holds for all elements."),
    e("sor", "sor(i, e)", "Whether it holds for an element."),
    e("and", "a and b", "Both hold."),
    e("or", "a or b", "One of them holds, or both."),
    e("xor", "a xor b", "One of them holds."),
    e("not", "not a", "It does not hold."),
    e("imp", "a imp b", "If the first holds, so does the second."),
    e("eqv", "a eqv b", "Both hold or neither."),
    e("inf", "inf", "Plus infinity: no bound."),
    e("eps", "eps", "A zero that is stored: a record is there."),
    e("na", "na", "Not available."),
    e("undf", "undf", "Undefined."),
    e("yes", "yes", "Is an element."),
    e("no", "no", "Is no element."),
    e("all", "Model m / all /;", "All equations declared so far."),
    e("using", "using lp", "The problem type: `lp`, `mip`, `nlp`, `dnlp`, `qcp`, `mcp`, `mpec`, `cns`, `minlp` …"),
    e("minimizing", "minimizing z", "The objective variable, as small as can be."),
    e("maximizing", "maximizing z", "The objective variable, as great as can be."),
    e("scenario", "scenario dict", "Solves once for each scenario of the dictionary."),
    e("=e=", "left =e= right", "Both sides are equal."),
    e("=l=", "left =l= right", "The left side is at most the right one."),
    e("=g=", "left =g= right", "The left side is at least the right one."),
    e("=n=", "left =n= right", "No relation: the row is free, or a complementarity pair decides."),
];

/// Attributes of variables and equations.
#[rustfmt::skip]
pub const RECORD_ATTRIBUTES: &[Entry] = &[
    e("l", "x.l", "Level: the value in the solution; before a solve, where it begins."),
    e("m", "x.m", "Marginal: how the objective moves when the bound or right side moves by one."),
    e("lo", "x.lo", "Lower bound."),
    e("up", "x.up", "Upper bound."),
    e("fx", "x.fx", "Both bounds and the level."),
    e("scale", "x.scale", "Scale for solvers, if the model has `scaleOpt = 1`."),
    e("prior", "x.prior", "Branching priority; `inf` relaxes the variable."),
    e("stage", "x.stage", "Stage of a stochastic program."),
    e("range", "x.range", "Distance of the bounds."),
    e("slack", "x.slack", "Distance of the level from the nearer bound."),
    e("slacklo", "x.slackLo", "Distance of the level from the lower bound."),
    e("slackup", "x.slackUp", "Distance of the level from the upper bound."),
    e("infeas", "x.infeas", "By how much the level violates its bounds."),
];

/// Attributes of the elements of sets.
#[rustfmt::skip]
pub const LABEL_ATTRIBUTES: &[Entry] = &[
    e("val", "i.val", "The label as a number."),
    e("pos", "i.pos", "Place in the set, from 1."),
    e("ord", "i.ord", "Place in the ordered set, from 1."),
    e("off", "i.off", "Place in the set, from 0."),
    e("rev", "i.rev", "Elements behind it."),
    e("uel", "i.uel", "Place among all labels."),
    e("len", "i.len", "Letters of the label."),
    e("tl", "i.tl", "The label as a text."),
    e("te", "i.te", "The element's text."),
    e("first", "i.first", "Whether it is the first."),
    e("last", "i.last", "Whether it is the last."),
    e("local", "i.local", "An index of its own inside of a sum."),
];

/// Attributes of models that are asked for most.
#[rustfmt::skip]
pub const MODEL_ATTRIBUTES: &[Entry] = &[
    e("modelstat", "m.modelStat", "Model status: 1 optimal, 2 locally optimal, 3 unbounded, 4 infeasible …"),
    e("solvestat", "m.solveStat", "Solver status: 1 normal completion, 2 iterations, 3 time …"),
    e("objval", "m.objVal", "Objective of the last solve."),
    e("objest", "m.objEst", "Bound on the objective, of a program with integers."),
    e("iterusd", "m.iterUsd", "Iterations of the last solve."),
    e("resusd", "m.resUsd", "Seconds of the last solve."),
    e("numequ", "m.numEqu", "Rows of the last solve."),
    e("numvar", "m.numVar", "Columns of the last solve."),
    e("suminfes", "m.sumInfes", "Sum of infeasibilities."),
    e("numinfes", "m.numInfes", "Number of infeasibilities."),
    e("reslim", "m.resLim", "Seconds that a solve may take."),
    e("iterlim", "m.iterLim", "Iterations that a solve may take."),
    e("optcr", "m.optCR", "Relative gap at which a program with integers is solved."),
    e("optca", "m.optCA", "Absolute gap at which a program with integers is solved."),
    e("holdfixed", "m.holdFixed", "1: fixed variables become constants."),
    e("optfile", "m.optFile", "Number of the option file."),
    e("scaleopt", "m.scaleOpt", "1: scales of the model are used."),
];

/// Functions: those that want a word. `check::functions` has them all.
#[rustfmt::skip]
pub const FUNCTIONS: &[Entry] = &[
    e("ord", "ord(i)", "Place of the element in its ordered set, from 1."),
    e("card", "card(i)", "Number of elements, or of records."),
    e("sameas", "sameAs(i,j)", "Whether two elements are the same label."),
    e("diag", "diag(i,j)", "1 if two elements are the same label, else 0."),
    e("exp", "exp(x)", "e to the power of x."),
    e("log", "log(x)", "Natural logarithm."),
    e("log2", "log2(x)", "Logarithm to base 2."),
    e("log10", "log10(x)", "Logarithm to base 10."),
    e("sqrt", "sqrt(x)", "Square root."),
    e("sqr", "sqr(x)", "Square."),
    e("power", "power(x, n)", "x to a whole power n."),
    e("rpower", "rPower(x, y)", "x to the power of y, x at least 0."),
    e("cvpower", "cvPower(c, x)", "A constant to the power of x."),
    e("vcpower", "vcPower(x, c)", "x to a constant power, x at least 0."),
    e("signpower", "signPower(x, y)", "sign(x)·|x|^y."),
    e("sin", "sin(x)", "Sine of an angle in radians."),
    e("cos", "cos(x)", "Cosine of an angle in radians."),
    e("tan", "tan(x)", "Tangent of an angle in radians."),
    e("arcsin", "arcSin(x)", "Angle in radians whose sine is x."),
    e("arccos", "arcCos(x)", "Angle in radians whose cosine is x."),
    e("arctan", "arcTan(x)", "Angle in radians whose tangent is x."),
    e("arctan2", "arcTan2(y, x)", "Angle in radians of the point (x, y)."),
    e("sinh", "sinh(x)", "Hyperbolic sine."),
    e("cosh", "cosh(x)", "Hyperbolic cosine."),
    e("tanh", "tanh(x)", "Hyperbolic tangent."),
    e("abs", "abs(x)", "Absolute value; of variables in `dnlp` only."),
    e("sign", "sign(x)", "−1, 0 or 1."),
    e("min", "min(x, y, …)", "The least of its arguments; of variables in `dnlp` only."),
    e("max", "max(x, y, …)", "The greatest of its arguments; of variables in `dnlp` only."),
    e("floor", "floor(x)", "Greatest whole number of at most x."),
    e("ceil", "ceil(x)", "Least whole number of at least x."),
    e("round", "round(x, n)", "x to n decimals; without n to a whole number."),
    e("trunc", "trunc(x)", "The whole part."),
    e("frac", "frac(x)", "What is behind the point."),
    e("mod", "mod(x, y)", "Remainder of x divided by y."),
    e("ifthen", "ifThen(c, x, y)", "x if the condition holds, else y."),
    e("uniform", "uniform(a, b)", "A random number between a and b."),
    e("uniformint", "uniformInt(a, b)", "A random whole number from a to b."),
    e("normal", "normal(mean, deviation)", "A random number, normally distributed."),
    e("gamma", "gamma(x)", "The gamma function."),
    e("errorf", "errorF(x)", "The normal distribution's integral from −∞ to x."),
    e("entropy", "entropy(x)", "−x·log x."),
    e("edist", "eDist(x, y, …)", "Euclidean length: √(x² + y² + …)."),
    e("div", "div(x, y)", "x/y."),
    e("div0", "div0(x, y)", "x/y, and 1e299 for y = 0."),
    e("fact", "fact(n)", "Factorial."),
    e("pi", "pi", "3.14159…"),
    e("poly", "poly(x, a0, a1, a2, …)", "Polynomial a0 + a1·x + a2·x² + …"),
    e("sigmoid", "sigmoid(x)", "1/(1 + exp(−x))."),
    e("jdate", "jDate(year, month, day)", "Day number of a date."),
    e("jnow", "jNow", "Day number of now."),
    e("gyear", "gYear(day)", "Year of a day number."),
    e("gmonth", "gMonth(day)", "Month of a day number."),
    e("gday", "gDay(day)", "Day of the month of a day number."),
    e("gdow", "gDow(day)", "Day of the week of a day number, 1 is Monday."),
    e("timeelapsed", "timeElapsed", "Seconds since the run began."),
];

/// Directives.
#[rustfmt::skip]
pub const DIRECTIVES: &[Entry] = &[
    e("title", "$title text", "Title of the model."),
    e("include", "$include file", "Reads another file here."),
    e("batinclude", "$batInclude file a b", "Reads another file with arguments, `%1`, `%2` …"),
    e("ontext", "$onText … $offText", "Lines that are not read."),
    e("offtext", "$offText", "Ends `$onText`."),
    e("set", "$set name value", "`%name%` stands for the value in this file and those that it includes."),
    e("setglobal", "$setGlobal name value", "`%name%` stands for the value everywhere."),
    e("setlocal", "$setLocal name value", "`%name%` stands for the value in this file."),
    e("eval", "$eval name expression", "`%name%` stands for the value of the expression."),
    e("evalglobal", "$evalGlobal name expression", "`%name%` stands for the value of the expression everywhere."),
    e("if", "$if condition statement", "The rest of the line only if the condition holds: `set x`, `declared p`, `exist file` …"),
    e("ife", "$ifE expression statement", "The rest of the line only if the expression is not 0."),
    e("ifi", "$ifI a == b statement", "As `$if`, capitals aside."),
    e("ifthen", "$ifThen condition … $else … $endIf", "Lines only if the condition holds."),
    e("ifthene", "$ifThenE expression … $endIf", "Lines only if the expression is not 0."),
    e("iftheni", "$ifThenI a == b … $endIf", "As `$ifThen`, capitals aside."),
    e("elseif", "$elseIf condition", "Another condition."),
    e("else", "$else", "Lines otherwise."),
    e("endif", "$endIf", "Ends `$ifThen`."),
    e("macro", "$macro name(a,b) text", "A macro: its text stands for each `name(…)`."),
    e("eolcom", "$eolCom //", "The mark of comments to the end of the line."),
    e("oneolcom", "$onEolCom", "Comments to the end of the line, behind `!!`."),
    e("inlinecom", "$inlineCom { }", "The marks of comments inside of lines."),
    e("oninline", "$onInline", "Comments inside of lines, between `/*` and `*/`."),
    e("onecho", "$onEcho > file … $offEcho", "Writes lines to a file."),
    e("offecho", "$offEcho", "Ends `$onEcho`."),
    e("onmulti", "$onMulti", "A symbol may get data more than once."),
    e("offmulti", "$offMulti", "Ends `$onMulti`."),
    e("onempty", "$onEmpty", "Data may be empty."),
    e("ondelim", "$onDelim … $offDelim", "Data with commas between columns, as in CSV files."),
    e("offdelim", "$offDelim", "Ends `$onDelim`."),
    e("onend", "$onEnd", "`loop … endloop` and its kin in the place of parentheses."),
    e("ondotl", "$onDotL", "A variable in an assignment means its level."),
    e("offdotl", "$offDotL", "Ends `$onDotL`."),
    e("onimplicitassign", "$onImplicitAssign", "Data that were never assigned are 0."),
    e("onorder", "$onOrder", "Lags need ordered sets."),
    e("offorder", "$offOrder", "Lags on any set."),
    e("gdxin", "$gdxIn file", "Opens a data file for `$load`."),
    e("load", "$load x y=z", "Takes symbols from the data file."),
    e("loaddc", "$loadDC x", "Takes symbols from the data file and checks their domains."),
    e("gdxout", "$gdxOut file", "Opens a data file for `$unload`."),
    e("unload", "$unload x", "Writes symbols to the data file."),
    e("abort", "$abort text", "Ends with a message."),
    e("exit", "$exit", "Ends this file."),
    e("stop", "$stop", "Ends the text."),
    e("terminate", "$terminate", "Ends the text; nothing is run."),
    e("goto", "$goto label", "Reads on behind `$label`."),
    e("label", "$label name", "A place that `$goto` reads on from."),
    e("onput", "$onPut … $offPut", "Each line is written by `put`."),
    e("kill", "$kill p", "Forgets the data of a symbol."),
    e("clear", "$clear p", "Forgets the values of a symbol."),
    e("echo", "$echo text > file", "Writes a line to a file."),
    e("log", "$log text", "Writes a line to the log."),
];

/// The entry of a word in a list; plural and `s` of declarations aside.
pub fn find(list: &'static [Entry], word: &str) -> Option<&'static Entry> {
    let small = word.to_ascii_lowercase();
    let known = |w: &str| list.iter().find(|e| e.word == w);
    known(&small)
        .or_else(|| known(small.strip_suffix('s')?))
        .or_else(|| match small.as_str() {
            "options" => known("option"),
            _ if small.starts_with("us") => known("using"),
            _ if small.starts_with("min") => known("minimizing"),
            _ if small.starts_with("max") => known("maximizing"),
            _ => None,
        })
}
