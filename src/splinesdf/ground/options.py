"""Keyword arguments that several functions share, typed and listed once."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., object])


def with_options(kind: type, defaults: Mapping[str, Any]) -> Callable[[Function], Function]:
    """Have help() and completion show the options of a function by name, with their defaults.

    Parameters
    ----------
    kind : TypedDict
        The options' names and types; the function takes them as ``**options: Unpack[kind]``.
    defaults : mapping
        Their defaults, in the same order.
    """

    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        options = [
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                default=value,
                annotation=getattr(hint, "__forward_arg__", hint),
            )
            for (name, value), hint in zip(
                defaults.items(), kind.__annotations__.values(), strict=True
            )
        ]
        shown = signature.replace(parameters=[*own, *options])
        function.__signature__ = shown  # type: ignore[attr-defined]
        return function

    return decorate


def check_known(function: str, given: Mapping[str, Any], kind: type) -> None:
    """Refuse keyword arguments that a function does not have, as Python does."""
    if unknown := set(given) - set(kind.__annotations__):
        raise TypeError(f"{function}() got an unexpected keyword argument {min(unknown)!r}")
