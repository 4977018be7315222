-- See run.sh.
local failed = false
local function check(what, ok, seen)
  if not ok then
    failed = true
  end
  print((ok and 'ok     ' or 'FAILED ') .. what .. (ok and '' or ': ' .. vim.inspect(seen)) .. '\n')
end
local function clients()
  return (vim.lsp.get_clients or vim.lsp.get_active_clients)()
end
vim.wait(20000, function()
  return #clients() > 0 and clients()[1].initialized ~= nil and clients()[1].server_capabilities ~= nil
end, 20)
check('the server is attached', #clients() == 1, #clients())
check('the syntax is loaded', vim.b.current_syntax == 'bmod', vim.b.current_syntax)

vim.api.nvim_buf_set_lines(0, -1, -1, false, { 'display nosuch;' })
vim.wait(20000, function()
  return #vim.diagnostic.get(0) > 0
end, 20)
local found = vim.diagnostic.get(0)
check('a slip is told', #found == 1 and found[1].code == 'E0301', found)

vim.fn.search('solve static')
vim.cmd('normal! w')
local client = clients()[1]
local at = vim.lsp.util.make_position_params(0, client.offset_encoding or 'utf-16')
local function ask(method, params)
  local answers = vim.lsp.buf_request_sync(0, method, params or at, 20000) or {}
  for _, a in pairs(answers) do
    return a.result
  end
end
local definition = ask('textDocument/definition')
check('a definition in the included file', definition and definition[1] and definition[1].uri:match('block_limit.blk$'), definition)
local hover = ask('textDocument/hover')
check('hover', hover and hover.contents.value:match('static theorem'), hover)
at.newName = 'upper'
local edit = ask('textDocument/rename', at)
vim.lsp.util.apply_workspace_edit(edit or {}, client.offset_encoding or 'utf-16')
check('a name changed', vim.fn.search('solve upper using lp', 'w') > 0, edit)
vim.cmd(failed and 'cquit!' or 'qall!')
