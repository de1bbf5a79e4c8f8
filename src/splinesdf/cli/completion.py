"""`splinesdf completion`: what a shell needs to complete commands, options and files."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

import splinesdf as ss

_SHELLS = ("bash", "zsh", "fish")


@click.command()
@click.argument("shell", type=click.Choice(_SHELLS))
def completion(shell: str) -> None:
    """Print the completion script for SHELL.

    bash: add to ~/.bashrc: eval "$(splinesdf completion bash)". zsh: the same in ~/.zshrc. fish:
    splinesdf completion fish > ~/.config/fish/completions/splinesdf.fish
    """
    kind = get_completion_class(shell)
    if kind is None:
        raise ss.InputError(f"expected a shell of {', '.join(_SHELLS)}, got {shell}")
    root = click.get_current_context().find_root()
    made = kind(root.command, {}, "splinesdf", "_SPLINESDF_COMPLETE")
    click.echo(made.source())
