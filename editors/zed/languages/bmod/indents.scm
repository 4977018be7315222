(group "(" ")" @end) @indent
(group "[" "]" @end) @indent
(group "{" "}" @end) @indent
(declaration) @indent
