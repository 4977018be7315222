" Layout as `bmod fmt` has it; `*` in the first column begins a comment.
setlocal shiftwidth=3 expandtab comments=b:* commentstring=*\ %s formatprg=bmod\ fmt\ -
if has('nvim')
  lua require('bmod').attach()
endif
