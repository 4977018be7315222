-- `bmod lsp` in Neovim 0.7 and later: `require('bmod').attach()` in a buffer; the file type does it by itself.
local M = { command = 'bmod' }

local function in_terminal(command)
  return function(lens)
    local file = (lens.arguments or {})[1] or vim.api.nvim_buf_get_name(0)
    vim.cmd('silent! write')
    vim.cmd('botright 15split | terminal ' .. vim.fn.shellescape(M.command) .. ' ' .. command .. ' ' .. vim.fn.shellescape(file))
  end
end

function M.attach()
  local name = vim.api.nvim_buf_get_name(0)
  local config = {
    name = 'bmod',
    cmd = { M.command, 'lsp' },
    root_dir = vim.fn.fnamemodify(name, ':p:h'),
    -- The lenses "Run" and "Why" open a terminal.
    commands = { ['bmod.run'] = in_terminal('run'), ['bmod.why'] = in_terminal('why') },
  }
  if vim.lsp.start then
    return vim.lsp.start(config)
  end
  -- Neovim 0.7: a client for all buffers.
  if not (M.client and vim.lsp.get_client_by_id(M.client)) then
    M.client = vim.lsp.start_client(config)
  end
  vim.lsp.buf_attach_client(0, M.client)
  return M.client
end

return M
