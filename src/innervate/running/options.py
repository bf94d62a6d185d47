"""Options that a function takes by name, as a TypedDict lists them."""

from collections.abc import Callable, Collection, Iterable, Mapping
from inspect import Parameter, signature
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., Any])


def takes(options: type, usual: Mapping[str, Any]) -> Callable[[Function], Function]:
    """Have `help` and a notebook show the options of a function, and what is usual."""

    def shown(function: Function) -> Function:
        found = signature(function)
        own = [one for one in found.parameters.values() if one.kind is not Parameter.VAR_KEYWORD]
        more = [
            Parameter(name, Parameter.KEYWORD_ONLY, default=usual[name], annotation=kind)
            for name, kind in options.__annotations__.items()
        ]
        cast(Any, function).__signature__ = found.replace(parameters=[*own, *more])
        return function

    return shown


def refuse_others(function: str, given: Iterable[str], known: Collection[str]) -> None:
    """Nothing passes unheard that a function has no use for.

    Raises:
        TypeError: one of these is no option of it.
    """
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise TypeError(f"{function} takes no {', '.join(unknown)}; it takes {', '.join(known)}")
