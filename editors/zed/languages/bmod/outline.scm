(declared name: (name) @name) @item
(definition . (name) @name ".." @context) @item
(definition . (call function: (name) @name) ".." @context) @item
