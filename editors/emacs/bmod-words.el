;;; bmod-words.el --- the words of bmod  -*- lexical-binding: t -*-
;; Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.

(defconst bmod-declarations
  '("sets" "set" "singleton" "aliass" "alias" "parameters" "parameter" "scalars" "scalar" "tables" "table" "variables" "variable" "equations" "equation" "models" "model" "acronyms" "acronym" "files" "file" "figure" "positive" "nonnegative" "negative" "free" "binary" "integer" "semicont" "semiint" "sos1" "sos2"))

(defconst bmod-statements
  '("abort" "break" "by" "continue" "display" "do" "downto" "draw" "else" "elseif" "endfor" "endif" "endloop" "endwhile" "execute_load" "execute_loadpoint" "execute_unload" "for" "if" "loop" "maximize" "maximizing" "minimize" "minimizing" "option" "options" "put" "putclose" "puthd" "putpage" "puttl" "repeat" "scenario" "solve" "then" "to" "until" "using" "while"))

(defconst bmod-operators
  '("and" "eq" "eqv" "ge" "gt" "imp" "le" "lt" "ne" "not" "or" "prod" "sand" "smax" "smin" "sor" "sum" "xor"))

(defconst bmod-functions
  '("abs" "arccos" "arcsin" "arctan" "arctan2" "beta" "betareg" "binomial" "bool_and" "bool_eqv" "bool_imp" "bool_not" "bool_or" "bool_xor" "card" "ceil" "centropy" "cos" "cosh" "cvpower" "diag" "div" "div0" "edist" "entropy" "errorf" "errorlevel" "execerror" "execseed" "exp" "fact" "floor" "frac" "gamma" "gammareg" "gamsrelease" "gamsversion" "gday" "gdow" "ghour" "gleap" "gmillisec" "gminute" "gmonth" "gsecond" "gyear" "handlecollect" "handledelete" "handlestatus" "handlesubmit" "heapfree" "heaplimit" "heapsize" "ifthen" "jdate" "jnow" "jstart" "jtime" "licenselevel" "licensestatus" "log" "log10" "log2" "logbeta" "loggamma" "logit" "lsemax" "lsemaxsc" "lsemin" "lseminsc" "mapval" "mathlastec" "mathlastrc" "mathoval" "max" "maxexecerror" "min" "mod" "ncpcm" "ncpf" "ncpvupow" "ncpvusin" "normal" "numcores" "ord" "pi" "platformcode" "poly" "power" "randbinomial" "randlinear" "randtriangle" "readycollect" "rel_eq" "rel_ge" "rel_gt" "rel_le" "rel_lt" "rel_ne" "round" "rpower" "sameas" "sigmoid" "sign" "signpower" "sin" "sinh" "sleep" "slexp" "sllog10" "slrec" "sqexp" "sqlog10" "sqr" "sqrec" "sqrt" "tan" "tanh" "timeclose" "timecomp" "timeelapsed" "timeexec" "timestart" "trunc" "uniform" "uniformint" "vcpower"))

(defconst bmod-constants
  '("inf" "eps" "na" "undf" "yes" "no" "all"))

(provide 'bmod-words)
;;; bmod-words.el ends here
