"""`splinesdf completion`: what a shell needs to complete commands, options and files."""

from __future__ import annotations

import click
from click.shell_completion import BashComplete, FishComplete, ZshComplete

_SHELLS = {"bash": BashComplete, "zsh": ZshComplete, "fish": FishComplete}


@click.command()
@click.argument("shell", type=click.Choice(list(_SHELLS)))
def completion(shell: str) -> None:
    """Print the completion script for SHELL.

    bash: add to ~/.bashrc: eval "$(splinesdf completion bash)". zsh: the same in ~/.zshrc. fish:
    splinesdf completion fish > ~/.config/fish/completions/splinesdf.fish
    """
    root = click.get_current_context().find_root()
    made = _SHELLS[shell](root.command, {}, "splinesdf", "_SPLINESDF_COMPLETE")
    click.echo(made.source())
