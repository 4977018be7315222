autocmd BufNewFile,BufRead *.blk,*.gms setfiletype bmod
