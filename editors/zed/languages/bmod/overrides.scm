(comment) @comment
[(string) (text)] @string
