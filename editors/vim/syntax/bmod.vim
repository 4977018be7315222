" Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.
if exists('b:current_syntax')
  finish
endif
syntax case ignore
syntax keyword bmodType set[s] singleton alias parameter[s] scalar[s] table[s] variable[s] equation[s] model[s] acronym[s] file[s] figure positive nonnegative negative free binary integer semicont semiint sos1 sos2
syntax keyword bmodStatement abort break by continue display do downto draw else elseif endfor endif endloop endwhile execute_load execute_loadpoint execute_unload for if loop maximize maximizing minimize minimizing option options put putclose puthd putpage puttl repeat scenario solve then to until using while
syntax keyword bmodOperator and eq eqv ge gt imp le lt ne not or prod sand smax smin sor sum xor
syntax keyword bmodConstant inf eps na undf yes no all pi
syntax match bmodFunction /\<\%(abs\|arccos\|arcsin\|arctan\|arctan2\|beta\|betareg\|binomial\|bool_and\|bool_eqv\|bool_imp\|bool_not\|bool_or\|bool_xor\|card\|ceil\|centropy\|cos\|cosh\|cvpower\|diag\|div\|div0\|edist\|entropy\|errorf\|errorlevel\|execerror\|execseed\|exp\|fact\|floor\|frac\|gamma\|gammareg\|gamsrelease\|gamsversion\|gday\|gdow\|ghour\|gleap\|gmillisec\|gminute\|gmonth\|gsecond\|gyear\|handlecollect\|handledelete\|handlestatus\|handlesubmit\|heapfree\|heaplimit\|heapsize\|ifthen\|jdate\|jnow\|jstart\|jtime\|licenselevel\|licensestatus\|log\|log10\|log2\|logbeta\|loggamma\|logit\|lsemax\|lsemaxsc\|lsemin\|lseminsc\|mapval\|mathlastec\|mathlastrc\|mathoval\|max\|maxexecerror\|min\|mod\|ncpcm\|ncpf\|ncpvupow\|ncpvusin\|normal\|numcores\|ord\|pi\|platformcode\|poly\|power\|randbinomial\|randlinear\|randtriangle\|readycollect\|rel_eq\|rel_ge\|rel_gt\|rel_le\|rel_lt\|rel_ne\|round\|rpower\|sameas\|sigmoid\|sign\|signpower\|sin\|sinh\|sleep\|slexp\|sllog10\|slrec\|sqexp\|sqlog10\|sqr\|sqrec\|sqrt\|tan\|tanh\|timeclose\|timecomp\|timeelapsed\|timeexec\|timestart\|trunc\|uniform\|uniformint\|vcpower\)\ze\s*[([{]/
syntax match bmodAttribute /[[:alnum:]_)]\.\zs\%(first\|fx\|holdfixed\|infeas\|iterlim\|iterusd\|l\|last\|len\|lo\|local\|m\|modelstat\|numequ\|numinfes\|numvar\|objest\|objval\|off\|optca\|optcr\|optfile\|ord\|pos\|prior\|range\|reslim\|resusd\|rev\|scale\|scaleopt\|slack\|slacklo\|slackup\|solvestat\|stage\|suminfes\|te\|tl\|uel\|up\|val\)\>/
syntax match bmodDirective /^\s*\$\+\s*\a\+/
syntax match bmodNumber /\<\d\+\%(\.\d*\)\?\%([eE][-+]\?\d\+\)\?\>/
syntax match bmodRelation /=[elgnxcb]=\|\.\./
syntax match bmodVariable /%[[:alpha:]_][[:alnum:]_.]*%/
syntax region bmodString start=/'/ end=/'/ oneline
syntax region bmodString start=/"/ end=/"/ oneline
syntax match bmodComment /^\*.*$/
syntax match bmodComment /\/\/.*$/
syntax region bmodComment start=/^\s*\$\+\s*ontext\>/ end=/^\s*\$\+\s*offtext\>/
highlight default link bmodType Type
highlight default link bmodStatement Statement
highlight default link bmodOperator Operator
highlight default link bmodConstant Constant
highlight default link bmodFunction Function
highlight default link bmodAttribute Identifier
highlight default link bmodDirective PreProc
highlight default link bmodNumber Number
highlight default link bmodRelation Operator
highlight default link bmodVariable Macro
highlight default link bmodString String
highlight default link bmodComment Comment
let b:current_syntax = 'bmod'
