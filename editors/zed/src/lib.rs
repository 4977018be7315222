//! Tells Zed how the language server is started: `bmod lsp`, with the program of the settings
//! (`"lsp": { "bmod": { "binary": { "path": "…" } } }`) or the one on the path.

use zed_extension_api::settings::LspSettings;
use zed_extension_api::{Command, Extension, LanguageServerId, Result, Worktree};

struct Bmod;

impl Extension for Bmod {
    fn new() -> Self {
        Self
    }

    fn language_server_command(&mut self, id: &LanguageServerId, project: &Worktree) -> Result<Command> {
        let binary = LspSettings::for_worktree(id.as_ref(), project)?.binary;
        let (path, arguments) = binary.map_or((None, None), |b| (b.path, b.arguments));
        let command = path
            .or_else(|| project.which("bmod"))
            .ok_or("the program `bmod` is not on the path; the setting lsp.bmod.binary.path may name it")?;
        Ok(Command {
            command,
            args: arguments.unwrap_or_else(|| vec!["lsp".into()]),
            env: project.shell_env(),
        })
    }
}

zed_extension_api::register_extension!(Bmod);
