# SPDX-License-Identifier: Apache-2.0
"""Type checks of the arguments of public functions and records against their annotations.

A chapter's `__init__` adds the checks to its public functions (`check_types_of`), so that internal calls are
unchecked. If a record validates its fields in `__post_init__`, their types are checked first (`Record`).
Numbers and arrays are checked by `validation` instead, which accepts whatever NumPy converts to numbers.
"""

from __future__ import annotations

import ast
import builtins
import collections.abc
import dataclasses
import difflib
import functools
import inspect
import re
import sys
import textwrap
import types
import typing
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from enum import Enum
from typing import Any, Final, NamedTuple, NoReturn, ParamSpec, TypeGuard, TypeVar

import numpy as np

from contact_dynamics.errors import UnknownArgumentError, WrongTypeError

P = ParamSpec("P")
R = TypeVar("R")

_NUMBERS: Final = {"int", "float", "complex", "ArrayLike", "FloatArray", "IntArray", "NDArray", "Vector2"}
_UNCHECKED: Final = {*_NUMBERS, "Any", "object"}
_MEANT: Final[dict[str, tuple[str, ...]]] = {
    **dict.fromkeys(("position", "point", "location", "pos", "p"), ("p_WB_W", "p_WC_W", "p_WS_W", "r")),
    **dict.fromkeys(("velocity", "linear_velocity", "vel"), ("v_WB_W", "v", "velocity")),
    **dict.fromkeys(("angular_velocity", "omega", "spin"), ("w_WB_W", "w", "angular_velocity")),
    **dict.fromkeys(("orientation", "quaternion", "attitude", "rotation", "q"), ("q_WB", "rotation")),
    **dict.fromkeys(("mu", "friction_coefficient", "kinetic_friction"), ("friction", "frictions")),
    **dict.fromkeys(("e", "coefficient_of_restitution", "bounce"), ("restitution", "restitutions")),
    **dict.fromkeys(("mass", "inertia", "density"), ("mass_properties", "I_B")),
    **dict.fromkeys(("vertices", "corners", "size"), ("vertices_B", "vertices_W", "shape")),
    **dict.fromkeys(("duration", "until", "timeout", "seconds", "max_time"), ("horizon", "stamp_ns")),
    **dict.fromkeys(("time", "times"), ("seconds", "horizon", "stamp_ns")),
    **dict.fromkeys(("samples", "n"), ("count",)),
    **dict.fromkeys(("floor", "surface", "ground", "obstacles"), ("surfaces",)),
    "v_WS_W": ("surface_velocity_W", "surface_velocities_W"),
    "w_WS_W": ("surface_angular_velocity_W", "surface_angular_velocities_W"),
    "a_WS_W": ("surface_acceleration_W", "surface_accelerations_W"),
    "normal": ("normal_W", "normals_W"),
    "law": ("restitution_law",),
    "force": ("force_W", "f"),
}
"""Names that newcomers guess, with the names probably meant. Arguments that begin with the guess are also
suggested."""

_BELONGS_TO: Final = {"parts": "Body.union makes one body of several parts"}
"""Names that newcomers give to a call that does not take them, with the call that does."""

_INTERNAL: Final = ("_", "HINT_IF", "ALLOWED")
"""Prefixes of internal names."""

_UNKNOWN: Final[tuple[int, tuple[type, ...]]] = (-1, ())
"""Position and types of an argument that a function does not have."""

_FUNCTION: Final[type] = Callable  # type: ignore[assignment]  # used as a class here
_SEQUENCES: Final = (collections.abc.Sequence, Collection, tuple, list)


class Expected(NamedTuple):
    """The values that an argument accepts.

    Attributes:
        types: The allowed types.
        elements: The allowed elements of a sequence, or None if no sequence is allowed.
    """

    types: tuple[type, ...]
    elements: Expected | None = None


class CallableChapter(types.ModuleType):
    """A chapter that can be called like its function of the same name: ``contact_dynamics.toss(...)``."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Call the function."""
        return _own_function(self)(*args, **kwargs)

    @property
    def __signature__(self) -> inspect.Signature:
        """The function's signature, for help and completion."""
        return inspect.signature(_own_function(self))


def _own_function(chapter: types.ModuleType) -> Any:
    return vars(chapter).get(chapter.__name__.rpartition(".")[2])


def check_types_of(page: dict[str, Any]) -> None:
    """Make the public functions of a chapter check the types of their arguments.

    A chapter with a function of its own name can be called like that function, and its help is the help of
    the function with a list of the other names. The chapter's own docstring is for readers of the source.

    Args:
        page: The ``globals()`` of the chapter's `__init__`, with ``__all__``.
    """
    for name in page["__all__"]:
        function = page[name]
        if inspect.isfunction(function) and not hasattr(function, "__wrapped__"):
            page[name] = checks_types(function)
            page[name].__module__ = page["__name__"]  # where pickle finds it
    chapter = sys.modules[page["__name__"]]
    function = _own_function(chapter)
    if inspect.isfunction(function):
        chapter.__class__ = CallableChapter
        call = f"{function.__name__}{inspect.signature(function)}".replace("'", "")
        gist, _, more = (inspect.getdoc(function) or "").partition("\n\n")
        others = textwrap.fill(", ".join(name for name in page["__all__"] if name != function.__name__), 100)
        alone = f"help({page['__name__']}.{function.__name__}) shows this text alone."
        internal = f"{alone} The modules under PACKAGE CONTENTS are internal. Other public names are:"
        # help of the chapter is that of the function
        chapter.__doc__ = f"{gist}\n\n{call}\n\n{more}\n\n{internal}\n{others}"


def checks_types(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function with a check of its arguments' names and types.

    It raises `UnknownArgumentError` for an unknown argument name, and `WrongTypeError` for an argument whose
    type does not match its annotation.
    """
    arguments: _Arguments | None = None

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        nonlocal arguments
        arguments = arguments or _Arguments(function)
        count = len(args)
        fits = count <= len(arguments.by_place)
        for value, kinds in zip(args, arguments.by_place):  # noqa: B905  `strict` takes time
            fits = fits and isinstance(value, kinds)
        for name, value in kwargs.items():
            place, kinds = arguments.by_keyword.get(name, _UNKNOWN)
            fits = fits and place >= count and isinstance(value, kinds)
        if not fits:
            arguments.check(args, kwargs)
        return function(*args, **kwargs)

    return checked


class _Arguments:
    """The arguments that a function accepts.

    Attributes:
        by_place: The types of each positional argument.
        by_keyword: The position and the types of each argument that may be given by name.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        annotations = {name: text for name, text in function.__annotations__.items() if name != "return"}
        self.function, self.parameters = function, inspect.signature(function).parameters
        self.expected = _expected(annotations, vars(sys.modules[function.__module__]))
        places = _places(self.parameters.values())
        kinds = {name: self._types_of(name) for name in self.parameters}
        self.by_place = [kinds[name] for name in places]
        self.by_keyword = {name: (places.get(name, len(kinds)), kinds[name]) for name in kinds}

    def _types_of(self, name: str) -> tuple[type, ...]:
        return self.expected[name].types if name in self.expected else (object,)

    def check(self, args: tuple[object, ...], kwargs: dict[str, Any]) -> None:
        """Raise an error for the first argument that is not accepted."""
        for name in kwargs:
            if name not in self.parameters:
                refuse_unknown(self.function, name, self.parameters)
        if len(args) > len(self.by_place) or any(self.by_keyword[name][0] < len(args) for name in kwargs):
            _refuse_places(self.function, self.parameters.values(), args, kwargs)
        for name, value in [*zip(self.parameters, args, strict=False), *kwargs.items()]:
            if not isinstance(value, self._types_of(name)):
                check_type(name, value, self.expected[name])


def _places(parameters: Iterable[inspect.Parameter]) -> dict[str, int]:
    """Return the position of each argument that may be given by position."""
    return {each.name: i for i, each in enumerate(parameters) if each.kind is each.POSITIONAL_OR_KEYWORD}


def _refuse_places(
    function: Callable[..., object],
    parameters: Collection[inspect.Parameter],
    args: Collection[object],
    kwargs: Collection[str],
) -> NoReturn:
    """Raise the error for too many positional arguments, or for an argument by position and by name."""
    places = _places(parameters)
    is_method = next(iter(places), "") in {"self", "cls"}
    by_place = [name for name in places if name not in {"self", "cls"}]
    by_name = [each.name for each in parameters if each.kind is each.KEYWORD_ONLY]
    given = len(args) - is_method
    twice = [name for name in kwargs if places.get(name, len(args)) < len(args)]
    words = f"{function.__qualname__} got {given} argument{'s' if given != 1 else ''} by place"
    words += f", and {twice[0]} by name too" if twice else ""
    also = f", and by name only {', '.join(by_name)}" if by_name else ""
    order = f"{by_place[0]}{_meaning(function, by_place[0])}" if len(by_place) == 1 else ""
    order = order or (f"{', '.join(by_place)} in this order" if by_place else "nothing by place")
    raise UnknownArgumentError(f"{words}. It takes {order}{also}")


def checks_fields(post_init: Callable[[Any], None], annotations: Mapping[str, str]) -> Callable[[Any], None]:
    """Return a record's ``__post_init__`` that checks the types of the fields first.

    A sequence becomes an immutable tuple. A field that is converted from other types states them as an
    annotation in ``field(metadata={"accepts": ...})``.
    """
    if _is_numeric(annotations.values()):
        return post_init
    expected_of: list[tuple[str, Expected]] | None = None

    @functools.wraps(post_init)
    def checked(self: Any) -> None:
        nonlocal expected_of
        if expected_of is None:
            given = {
                one.name: one.metadata.get("accepts", annotations[one.name])
                for one in dataclasses.fields(self)
                if one.init and one.name in annotations
            }
            expected_of = [*_expected(given, vars(sys.modules[type(self).__module__])).items()]
        for name, expected in expected_of:
            value = getattr(self, name)
            if not isinstance(value, expected.types):
                if type(value) is not tuple and expected.elements is not None and _is_iterable(value):
                    value = tuple(value)
                    object.__setattr__(self, name, value)
                check_type(name, value, expected)
        post_init(self)

    return checked


def checks_names(init: Callable[..., None]) -> Callable[..., None]:
    """Return a record's ``__init__`` that raises `UnknownArgumentError` for arguments that it does not have.

    The error names the field probably meant, the missing fields, or all fields if positional arguments are
    given to a record with keyword-only arguments.
    """

    @functools.wraps(init)
    def checked(self: object, *args: object, **fields: object) -> None:
        try:
            init(self, *args, **fields)
        except TypeError:
            _check_names(type(self), fields, by_place=len(args))
            raise

    return checked


def _check_names(made: type, arguments: Mapping[str, object], by_place: int = 0) -> None:
    """Raise `UnknownArgumentError` for an unknown or missing argument of a class.

    It is also raised if ``by_place`` arguments are positional and the class has only keyword arguments.
    """
    names = dict(inspect.signature(made.__init__).parameters)  # type: ignore[misc]  # not called
    names.pop("self", None)
    if by_place:
        if any(one.kind is not one.KEYWORD_ONLY for one in names.values()):
            return
        words = f"{made.__qualname__} takes arguments only by name, such as {next(iter(names))}=..."
        listed = ", ".join(names)
        raise UnknownArgumentError(f"{words}, got {by_place} by place. It has {listed}") from None
    for name in arguments:
        if name not in names:
            refuse_unknown(made, name, tuple(names))
    missing = [name for name, one in names.items() if _is_required(one) and name not in arguments]
    if missing:
        listed = ", ".join(f"{name}{_meaning(made, name)}" for name in missing)
        raise UnknownArgumentError(f"{made.__qualname__} requires {listed}") from None


def _is_required(parameter: inspect.Parameter) -> bool:
    return parameter.kind is parameter.KEYWORD_ONLY and parameter.default is parameter.empty


def refuse_unknown(called: Callable[..., object], name: str, allowed: Collection[str]) -> NoReturn:
    """Raise the error for an unknown argument name, with the name probably meant and its description."""
    known = [one for one in allowed if one not in {"self", "cls"}]
    guesses = [one for one in _MEANT.get(name, ()) if one in known]
    guesses += [one for one in known if one.startswith(f"{name}_")]
    guesses += difflib.get_close_matches(name, known, n=1)
    words = f"{called.__qualname__} has no argument {name!r}"
    if guesses:
        words += f", did you mean {guesses[0]}{_meaning(called, guesses[0])}?"
    else:
        words += "."
    hint = _BELONGS_TO.get(name, getattr(called, "HINT_IF_UNKNOWN", ""))
    raise UnknownArgumentError(f"{words} It has {', '.join(known)}{'; ' if hint else ''}{hint}") from None


def no_attribute(record: object, name: str) -> str:
    """Return the error for an unknown attribute of a record, with the attribute probably meant."""
    kind = type(record)
    fields = _shown_fields(record)
    hidden = {one.name for one in _fields_of(record)}
    known = [*fields, *(one for one in dir(kind) if one not in hidden and not one.startswith(_INTERNAL))]
    guesses = []
    for meant in (name, *_MEANT.get(name, ())):
        guesses += [one for one in fields if one == meant]
        for field in fields:
            value = getattr(record, field)
            is_list = isinstance(value, tuple) and len(value) > 0
            if meant in _shown_fields(value[0] if is_list else value):
                guesses.append(f"{field}{'[0]' if is_list else ''}.{meant}")
    guesses += [one for one in known if one.startswith(f"{name}_")]
    guesses += difflib.get_close_matches(name, known, n=1)
    hint = f", did you mean {guesses[0]}?" if guesses else "."
    return f"{kind.__name__} has no attribute {name!r}{hint} It has {', '.join(known)}"


def _fields_of(record: object) -> tuple[dataclasses.Field[Any], ...]:
    return dataclasses.fields(record) if dataclasses.is_dataclass(record) else ()


def _shown_fields(record: object) -> list[str]:
    return [one.name for one in _fields_of(record) if one.repr and not one.name.startswith("_")]


def _meaning(called: Callable[..., object], name: str) -> str:
    """Return the first sentence of an argument's description, in parentheses, or an empty string."""
    meaning = re.search(
        rf"^\s*{name}: (.+?)(\.\s|\.?\n\s*\w+: |\.?\n\n|\.?\Z)",
        inspect.getdoc(called) or "",
        re.MULTILINE | re.DOTALL,
    )
    return f" ({' '.join(meaning[1].split())})" if meaning else ""


def check_type(field: str, value: object, expected: Expected) -> None:
    """Raise `WrongTypeError` if a value has the wrong type."""
    if isinstance(value, expected.types):
        return
    if expected.elements is None or not _is_iterable(value) or isinstance(value, Iterator):
        _refuse(field, value, expected)
    for i, element in enumerate(value):
        if not isinstance(element, expected.elements.types):
            check_type(f"{field}[{i}]", element, expected.elements)


def in_words(value: object) -> str:
    """Return a description of a value for an error."""
    if value is None:
        return "None"
    if isinstance(value, Enum):
        return f"{type(value).__name__}.{value.name}"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    kind = _with_article(type(value).__name__)
    return f"{value!r}, {kind}" if isinstance(value, str | bytes | int | float) else kind


def members_in_words(kind: type[Enum]) -> str:
    """Return the members of an enumeration for an error."""
    return " or ".join(f"{kind.__name__}.{one.name}" for one in kind)


def _is_iterable(value: object) -> TypeGuard[Iterable[object]]:
    """Return whether a value is iterable. Strings, and mappings, which iterate over keys, do not count."""
    if isinstance(value, tuple | list):  # the common case
        return True
    scalar = isinstance(value, np.ndarray) and value.ndim == 0
    return isinstance(value, Iterable) and not scalar and not isinstance(value, str | bytes | Mapping)


def _refuse(field: str, value: object, expected: Expected) -> NoReturn:
    """Raise the error, with a hint if a field of the value has the expected type, or its type has a hint."""
    found = in_words(value) + getattr(type(value), "HINT_IF_WRONG", "")
    for name in getattr(type(value), "__dataclass_fields__", ()):
        if isinstance(getattr(value, name), tuple({*expected.types} - {type(None), str})):
            found += f", whose {name} is one"
            break
    raise WrongTypeError(field, found, _expected_in_words(expected))


def _expected_in_words(expected: Expected) -> str:
    words = []
    for kind in expected.types:
        if kind is type(None):
            words.append("None")
        elif issubclass(kind, Enum):
            words.append(members_in_words(kind))
        elif kind is bool:
            words.append("True or False")
        elif kind is _FUNCTION:
            words.append("a function")
        elif kind not in {np.bool_, Iterator}:
            words.append(vars(kind).get("ALLOWED", _with_article(kind.__name__)))
    if expected.elements is not None:
        each = " or ".join(vars(kind).get("ALLOWED", kind.__name__) for kind in expected.elements.types)
        words.insert(0, f"a sequence of {each}")
    return " or ".join(words)


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}"


def _is_numeric(annotations: Collection[str]) -> bool:
    """Return whether annotations contain only numbers and arrays, without resolving the names."""
    return {*re.findall(r"\w+", " ".join(annotations))} <= {*_UNCHECKED, "None"}


def _expected(annotations: Mapping[str, str], module: Mapping[str, Any]) -> dict[str, Expected]:
    """Return the expected values of arguments by name, except for numbers and arrays."""
    found = {
        name: _expected_by(ast.parse(text, mode="eval").body, module) for name, text in annotations.items()
    }
    return {name: expected for name, expected in found.items() if expected is not None}


def _expected_by(node: ast.expr, module: Mapping[str, Any]) -> Expected | None:
    """Return the expected values of an annotation, or None for numbers and arrays."""
    if isinstance(node, ast.Constant):
        return Expected((type(None),)) if node.value is None else _expected_of(node.value, module)
    if isinstance(node, ast.BinOp):  # lazily, since an operand beside a number may be undefined
        return _either(_expected_by(side, module) for side in (node.left, node.right))
    if isinstance(node, ast.Subscript):
        return _generic(node, module)
    if isinstance(node, ast.Name) and node.id not in _UNCHECKED:
        return _expected_of(*_named(node.id, module))
    return None


def _generic(node: ast.Subscript, module: Mapping[str, Any]) -> Expected | None:
    """Return the expected values of an annotation with parameters."""
    if not isinstance(node.value, ast.Name) or node.value.id in _UNCHECKED:
        return None
    outer, _ = _named(node.value.id, module)
    inner: ast.expr | None = node.slice
    if isinstance(inner, ast.Tuple):  # any length, as in tuple[Body, ...]
        ellipsis = isinstance(inner.elts[-1], ast.Constant) and inner.elts[-1].value is ...
        inner = inner.elts[0] if ellipsis else None
    if outer in {*_SEQUENCES, Iterable}:
        elements = None if inner is None else _expected_by(inner, module)
        once = (Iterator,) if outer is Iterable else ()  # its elements are not checked here
        return None if elements is None else Expected(once, elements)
    return _expected_of(outer, module)


def _expected_of(kind: object, module: Mapping[str, Any]) -> Expected | None:
    """Return the expected values of a type. A string is an annotation of the module."""
    if isinstance(kind, str):
        return _expected_by(ast.parse(kind, mode="eval").body, module)
    if isinstance(kind, types.UnionType):
        return _either(_expected_of(one, module) for one in typing.get_args(kind))
    if kind is bool:
        return Expected((bool, np.bool_))
    if typing.get_origin(kind) is Callable:
        kind = Callable
    return Expected((kind,)) if isinstance(kind, type) and kind.__name__ not in _UNCHECKED else None


def _either(options: Iterable[Expected | None]) -> Expected | None:
    """Return the expected values of a union, or None, which means unchecked, if it contains a number."""
    known = []
    for one in options:
        if one is None:
            return None
        known.append(one)
    elements = [one.elements for one in known if one.elements is not None]
    return Expected(
        tuple(kind for one in known for kind in one.types), _either(elements) if elements else None
    )


def _named(name: str, module: Mapping[str, Any]) -> tuple[Any, Mapping[str, Any]]:
    """Return the object that a name in an annotation refers to, and the namespace that contains it.

    Modules import names in annotations only for the type checker. Each name is unique in this package, so
    that the defining module is searched for.
    """
    ours = (
        vars(each)
        for path, each in list(sys.modules.items())
        if path.startswith(f"{__package__}.") and each is not None
    )
    for names in (module, vars(collections.abc), vars(typing), vars(builtins), *ours):
        found = names.get(name)
        if found is not None and not isinstance(found, types.ModuleType):
            return found, names
    raise NameError(f"{name} of an annotation in {module['__name__']} is not defined")
