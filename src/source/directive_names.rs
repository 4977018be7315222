//! The names of the directives: those that are accepted and do nothing, and the others, for "did you mean".

/// Switches that change nothing here, as `$onX` and `$offX`.
#[rustfmt::skip]
pub(super) const SILENT_SWITCHES: &[&str] = &[
    "listing", "list", "symlist", "symxref", "uellist", "uelxref", "upper", "digit", "include", "warning",
    "global", "local", "log", "expand", "macro", "ident", "recurse", "embedded", "checkerrorlevel",
    "filtered", "suffixdlvars", "suffixalgebravars", "dollar", "dotscale", "hidden", "external", "save",
    "externalinput", "externaloutput", "verbatim", "strictdomain", "case", "localvars", "margin", "float",
    "textmode", "prefix", "fold", "idcprotect", "epstozero",
];

/// Directives that change nothing here, with nothing or one word behind them.
#[rustfmt::skip]
pub(super) const SILENT: &[&str] = &[
    "double", "single", "eject", "lines", "stars", "use205", "use225", "use999", "showvariables", "version",
    "warning", "compress", "decompress", "encrypt", "protect", "expose", "purge", "hide", "save", "funclibin",
    "prefixloadpath", "scratchfilename", "show", "dimension", "ident",
];

/// Files of `$libInclude` that hand data to another program, and give nothing back.
#[rustfmt::skip]
pub(super) const EXPORTS: &[&str] = &[
    "gams2tbl", "gams2txt", "gnuplot", "gnuplotxyz", "gnupltxy", "win32", "xlchart", "xldump", "xlexport",
];

/// Directives with the rest of their line as argument, without effect here.
#[rustfmt::skip]
pub(super) const SILENT_LINES: &[&str] = &[
    "stitle", "subtitle", "remark", "hidden", "comment_", "setddlist",
];

/// Other directives, for "did you mean".
#[rustfmt::skip]
pub(super) const OTHERS: &[&str] = &[
    "title", "include", "batinclude", "libinclude", "sysinclude", "set", "setlocal", "setglobal", "setenv",
    "drop", "droplocal", "dropglobal", "dropenv", "eval", "evallocal", "evalglobal", "if", "ifi", "ife",
    "ifthen", "iftheni", "ifthene", "elseif", "elseifi", "elseife", "else", "endif", "goto", "label", "exit",
    "stop", "terminate", "abort", "error", "clearerror", "escape", "macro", "ontext", "offtext", "oneolcom",
    "offeolcom", "eolcom", "oninline", "offinline", "inlinecom", "comment", "onmulti", "offmulti", "onmultir",
    "onempty", "offempty", "oneps", "offeps", "onundf", "offundf", "onorder", "offorder", "ondotl", "offdotl",
    "ondelim", "offdelim", "log", "echo", "echon", "onecho", "offecho", "call", "execute", "gdxin", "gdxout",
    "gdxload", "gdxloadall", "gdxunload", "load", "loaddc", "loadm", "loadr", "unload", "onput", "onputs",
    "onputv", "offput", "kill", "clear", "shift", "prefixpath", "dollar", "maxcol", "mincol", "maxgoto", "setargs",
    "setnames", "phantom", "onend", "offend", "onlisting", "offlisting", "onsymxref", "offsymxref",
    "onsymlist", "offsymlist", "onuelxref", "offuelxref", "onuellist", "offuellist", "onupper", "offupper",
    "onimplicitassign", "onstrictsingleton", "onembeddedcode", "onnestcom", "offnestcom",
];
