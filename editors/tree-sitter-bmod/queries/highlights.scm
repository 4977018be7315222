; Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.
(comment) @comment
((comment) @comment.doc
  (#match? @comment.doc "^[*][=>#!]"))
(directive_word) @preproc
(directive_text) @string.special
[(type) (table_word)] @type
(keyword) @keyword
(string) @string
(text) @string
(number) @number
(percent) @constant
[(relation) (operator) ".."] @operator
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
[";" ","] @punctuation.delimiter
(declared name: (name) @variable)
(definition . (name) @function)
(definition . (call function: (name) @function))
((call function: (name) @function.builtin)
  (#match? @function.builtin "^(?i:abs|arccos|arcsin|arctan|arctan2|beta|betareg|binomial|bool_and|bool_eqv|bool_imp|bool_not|bool_or|bool_xor|card|ceil|centropy|cos|cosh|cvpower|diag|div|div0|edist|entropy|errorf|errorlevel|execerror|execseed|exp|fact|floor|frac|gamma|gammareg|gamsrelease|gamsversion|gday|gdow|ghour|gleap|gmillisec|gminute|gmonth|gsecond|gyear|handlecollect|handledelete|handlestatus|handlesubmit|heapfree|heaplimit|heapsize|ifthen|jdate|jnow|jstart|jtime|licenselevel|licensestatus|log|log10|log2|logbeta|loggamma|logit|lsemax|lsemaxsc|lsemin|lseminsc|mapval|mathlastec|mathlastrc|mathoval|max|maxexecerror|min|mod|ncpcm|ncpf|ncpvupow|ncpvusin|normal|numcores|ord|pi|platformcode|poly|power|randbinomial|randlinear|randtriangle|readycollect|rel_eq|rel_ge|rel_gt|rel_le|rel_lt|rel_ne|round|rpower|sameas|sigmoid|sign|signpower|sin|sinh|sleep|slexp|sllog10|slrec|sqexp|sqlog10|sqr|sqrec|sqrt|tan|tanh|timeclose|timecomp|timeelapsed|timeexec|timestart|trunc|uniform|uniformint|vcpower)$"))
((name) @keyword.operator
  (#match? @keyword.operator "^(?i:and|eq|eqv|ge|gt|imp|le|lt|ne|not|or|prod|sand|smax|smin|sor|sum|xor)$"))
((name) @constant.builtin
  (#match? @constant.builtin "^(?i:inf|eps|na|undf|yes|no|all|pi)$"))
((label) @constant.builtin
  (#match? @constant.builtin "^(?i:inf|eps|na|undf|yes|no|all|pi)$"))
((statement (name) @keyword)
  (#match? @keyword "^(?i:using|minimizing|maximizing|minimize|maximize|scenario|do|then|to|downto|by)$"))
((attribute name: (name) @property)
  (#match? @property "^(?i:first|fx|holdfixed|infeas|iterlim|iterusd|l|last|len|lo|local|m|modelstat|numequ|numinfes|numvar|objest|objval|off|optca|optcr|optfile|ord|pos|prior|range|reslim|resusd|rev|scale|scaleopt|slack|slacklo|slackup|solvestat|stage|suminfes|te|tl|uel|up|val)$"))
