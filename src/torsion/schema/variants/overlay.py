"""What a case of a file changes, as the file's values with their places: keys replaced, multiplied or removed."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from decimal import Context, Decimal
from fractions import Fraction
from typing import Any

from torsion import units
from torsion.errors import Fault, Path, Refusal, nearest
from torsion.fields import shown
from torsion.model.parts import Part
from torsion.schema.declaration_reader import KEYS_BY_ALIAS, SECTIONS_BY_ALIAS, entries_of
from torsion.study import Change, Study
from torsion.user_files import Node, Source, printable

SECTIONS = (
    "materials",
    "operation",
    "damping",
    "links",
    "excitations",
    "analyses",
)  # that a key may begin with
NOT_BY_KEY = {  # section: what changes it
    "rules": "the case's own key `rules`",
    "train": "the names of its components, as in `flywheel.inertia`",
    "name": "nothing: the name of a case is its key",
    "description": "nothing: it is text",
    "cases": "another case: `based_on`",
    "document": "remove it here: it is the same for all cases",
}
STEP = re.compile(
    r"""\s*("[^"]*"|'[^']*'|[^."']+)\s*(\.|$)"""
)  # of a key path: a word, in quotes where it has dots
DIGITS = Context(prec=40)  # more than any figure has: what a factor multiplies stays exact
MAIN = ("train",)  # path of the main train
LONGEST = 60  # characters of a value in words
STIFFNESSES = (  # of a coupling
    ("stiffness",),
    ("clearance", "stiffness"),
    ("prony", "stiffness"),
    ("fractional", "stiffness"),
    ("fractional", "k1"),
    ("flexibility",),
)
LISTED = (  # lists of them, and where in an entry
    (("stages",), ("stiffness",)),
    (("table", "stiffness"), ()),
    (("prony", "terms"), (0,)),
)


@dataclass
class Overlay:
    """What one case changes of a file that a study was read from, collected before it is applied."""

    source: Source
    study: Study  # that was read from it
    faults: list[Fault] = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)
    permits_no_change: bool = False  # a value may be what it is already
    puts: list[tuple[Path, Node]] = field(default_factory=list)
    removed: dict[Path, None] = field(default_factory=dict)

    @contextmanager
    def noting(self, fault: Path) -> Iterator[None]:
        """Note what is refused of a key of the case, which stands there."""
        try:
            yield
        except Refusal as refusal:
            self.faults.append(Fault(fault, refusal.message, refusal.hint, at_key=True))

    def put(self, path: Path, value: Node) -> None:
        """A value in place of what stands at a path, or beside it."""
        # Of what a table states, the case states this.
        file = Source(self.source.name, self.source.text)
        self.puts.append((path, replace(value, source=value.source or file)))

    def change(self, words: str, value: Node, factor: Fraction | None = None) -> None:
        """Put a value where the words of a key point, or the number there times a factor; raises Refusal."""
        path = self.path(words)
        given, made = self.source.at(path), value.value
        if factor is None and given is not None and given.value == made:
            if not self.permits_no_change:
                message = f"`{printable(words)}` is {in_words(made)} already: nothing changes"
                raise Refusal(message, "give another value, or leave it out")
            return
        if factor is not None and given is None:
            message = (
                f"`{printable(words)}` is not given, and only what the file gives is multiplied"
            )
            raise Refusal(message, "give its value with `set`")
        if factor is not None and given is not None:
            if (made := multiplied(given.value, factor)) is None:
                message = f"{shown(given.value)} is not a number that can be multiplied"
                raise Refusal(message, "give the new value with `set`")
            value = replace(value, plain=made)
        before = "not given" if given is None else in_words(given.value)
        self.changes.append(Change(words, before, in_words(made)))
        self.put(path, value)

    def path(self, words: str) -> Path:
        """The path in the file that the words of a key stand for; raises Refusal."""
        first, is_quoted, steps = self._steps(words)
        start: Path = (first,)
        named = next((part for part in self.study.train.parts if part.name == first), None)
        if is_quoted or first not in SECTIONS:
            if named is None:
                if first in NOT_BY_KEY and not is_quoted:
                    hint = f"what changes it: {NOT_BY_KEY[first]}"
                    raise Refusal(f"`{first}` is not changed by its key", hint)
                names = [part.name for part in self.study.train.parts]
                possible = [*names, *SECTIONS]
                near = nearest(first, possible)
                hint = f"did you mean `{near}`?" if near else f"there is {', '.join(possible)}"
                dotted = (name for name in names if "." in name and words.startswith(name))
                if name := next(dotted, ""):
                    hint = f'a name that has dots stands in quotes: `"{name}"{words[len(name) :]}`'
                message = f"no component and no section is called `{printable(first)}`"
                raise Refusal(message, hint)
            if not steps:
                hint = f"for example `{first}.inertia`; `remove: [{first}]` takes it away"
                raise Refusal(f"`{printable(words)}` is a component without a key", hint)
            start = named.path
        elif named is not None:
            hint = f'write `"{first}".{steps[0] if steps else "key"}` for the component, or give it another name'
            raise Refusal(f"`{first}` is a section and a component", hint)
        if start != (first,) and steps[0] == "name":
            raise Refusal("a case changes no names", "components have the values of the file")
        if start[-1] == "coupling" and steps[0] in ("from", "size"):
            message = f"`{printable(words)}` changes the row that the coupling was read from"
            raise Refusal(message, "a case sets its figures: `stiffness`, `psi`, ...")
        return self._down(start, steps, words)

    def _steps(self, words: str) -> tuple[str, bool, list[str]]:
        """The first word of a key path, whether it stands in quotes, and those behind it."""
        words_found, end = list[str](), 0
        while end < len(words) and (step := STEP.match(words, end)):
            words_found.append(step[1].strip())
            end = step.end()
        if not words_found or end < len(words) or words.rstrip().endswith("."):
            hint = "names and keys with a dot between, as in `flywheel.inertia`; a name that has dots in quotes"
            raise Refusal(f"`{printable(words)}` is not a path to a key", hint)
        plain = [step[1:-1] if step[0] in "\"'" else step for step in words_found]
        aliases = SECTIONS_BY_ALIAS.get(plain[0], KEYS_BY_ALIAS)
        return plain[0], words_found[0] != plain[0], [aliases.get(word, word) for word in plain[1:]]

    def _down(self, path: Path, steps: list[str], words: str) -> Path:
        """The path that follows the steps; items of a list go by their number, from 1."""
        node = self.source.at(path)
        for step in steps:
            value = None if node is None else node.value
            if isinstance(value, list):
                if not step.isdecimal() or not 1 <= int(step) <= len(value):
                    hint = f"one of its items by number, 1 to {len(value)}"
                    message = (
                        f"`{printable(step)}` is not an item of the list in `{printable(words)}`"
                    )
                    raise Refusal(message, hint)
                path = (*path, int(step) - 1)
            elif value is None or isinstance(value, dict):
                path = (*path, step)
            else:
                message = f"`{path[-1]}` is {in_words(value)}, which has no `{printable(step)}`"
                raise Refusal(message, f"set `{path[-1]}` as a whole")
            node = None if node is None else node.parts.get(path[-1])
        return path

    def applied(self) -> Source:
        """The file with all of it; components keep the names that they have without it."""
        root = self.source.root
        for path, value in self.puts:
            root = _put_in(root, path, value)

        # From behind, so that items of a list that are still to go keep their numbers.
        in_order = sorted(
            self.removed, key=lambda path: [(isinstance(step, str), step) for step in path]
        )
        for path in reversed(in_order):
            root = _without(root, path)
        return replace(self.source, root=root)


def _put_in(node: Node, path: Path, new: Node) -> Node:
    """The same with another value at a path; mappings on the way to it are made."""
    step, deeper = path[0], path[1:]
    if deeper:
        part = node.parts.get(step) or Node({}, *new.place, key_place=new.place, source=new.source)
        new = _put_in(part, deeper, new)
    kind: Any = [] if isinstance(node.plain, list) else {}
    return replace(node, plain=kind, parts={**node.parts, step: new})


def _without(node: Node, path: Path) -> Node:
    """The same without what stands at a path; the items behind it in a list move up."""
    step, deeper = path[0], path[1:]
    if step not in node.parts:
        return node
    parts = dict(node.parts)
    if deeper:
        parts[step] = _without(parts[step], deeper)
    else:
        del parts[step]
    if isinstance(node.plain, list):
        return node.as_list(parts.values())
    return node.as_mapping(parts)


def multiplied(value: Any, factor: Fraction) -> int | float | str | None:
    """A number of the file, or one with its unit, times a factor; None for anything else.

    >>> multiplied("180 kN*m/rad", Fraction("1.15")), multiplied(40, Fraction("0.5")), multiplied("steel", Fraction(2))
    ('207 kN*m/rad', 20, None)
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    if isinstance(value, str):
        try:
            amount, unit = units.amount(value)
        except Refusal:
            return None
        # The digits of the product, exact where they end.
        product = amount * factor
        quotient = DIGITS.divide(Decimal(product.numerator), Decimal(product.denominator))
        digits = quotient.normalize(DIGITS)
        is_short = -12 <= digits.adjusted() <= 15
        figure = f"{digits:f}" if is_short else f"{digits:E}".replace("+", "")
        return None if re.match(r"1/[0-9]", unit) else f"{figure} {unit}".strip()
    try:
        made = Fraction(repr(value)) * factor
        return int(made) if isinstance(value, int) and made.denominator == 1 else float(made)
    except (ValueError, OverflowError):  # not finite
        return None


def in_words(value: Any) -> str:
    """A value of the file on one line."""
    return printable(_flow(value), LONGEST)


def _flow(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, float):
        return f"{value:.15g}"
    text = "nothing" if value is None else str(value)
    return text.lower() if isinstance(value, bool) else text


def remove_components(overlay: Overlay, names: Sequence[str], fault: Path) -> None:
    """Take components, or keys, away by their names; `fault` is the place of the list of names."""
    parts = {part.name: part for part in overlay.study.train.parts}
    entries: dict[Path, None] = {}  # of the lists of components
    ends: dict[Path, Path] = {}  # entry of the main train that a name stands for: where it is named
    stated = overlay.source.at(fault)
    for position, name in enumerate(names):
        # A name stands in a list, or alone.
        is_list = stated is not None and isinstance(stated.value, list)
        fault_path = (*fault, position) if is_list else fault
        if name in parts:
            path = parts[name].path[:-1]
            if path[:-1] == MAIN and parts[name].kind != "branch":
                ends[path] = fault_path
            else:
                # Outside the main train all of a branch behind it goes too, and itself where none is left.
                line, number = path[:-1], path[-1]
                gone = [path]
                if path[0] != "links" and parts[name].kind != "branch":
                    node = overlay.source.at(line) or Node([], 1, 1)
                    gone = [(*line, k) for k in range(int(number), len(node.value))]
                    gone = [line[:-2]] if number == 0 and line[-2] == "branch" else gone
                entries |= dict.fromkeys(gone)
            continue
        with overlay.noting(fault_path):
            key_path = overlay.path(name)
            given = overlay.source.at(key_path)
            if given is None:
                message = f"`{printable(name)}` is not given: nothing changes"
                overlay.faults.append(Fault(fault_path, message, "leave it out"))
                continue
            overlay.changes.append(Change(name, in_words(given.value), "not given"))
            overlay.removed[key_path] = None
    entries |= dict.fromkeys(_main_entries(overlay, ends))
    if not overlay.faults and entries:
        _remove_entries(overlay, list(entries), fault)


def _main_entries(overlay: Overlay, ends: dict[Path, Path]) -> list[Path]:
    """The entries of the main train that are named, from one of its ends on, with the branches that they carry."""
    if not ends:
        return []
    body = (overlay.source.at(MAIN) or Node([], 1, 1)).value
    kept, gone, carrier_goes = list[int](), list[int](), False
    for k, entry in enumerate(body):
        if not (isinstance(entry, dict) and "branch" in entry):
            carrier_goes = (*MAIN, k) in ends
        (gone if carrier_goes else kept).append(k)
    if not kept:
        hint = "a case keeps the component whose speed is meant, and what turns with it"
        fault = Fault(next(iter(ends.values())), "nothing of the main train is left", hint)
        overlay.faults.append(fault)
        return []
    inside = [k for k in gone if kept[0] < k < kept[-1] and (*MAIN, k) in ends]
    for k in inside:
        hint = "name all components from it to an end of the main train; a branch leaves with its first component"
        message = "it stands between other parts of the main train"
        overlay.faults.append(Fault(ends[*MAIN, k], message, hint))
    return [] if inside else [(*MAIN, k) for k in gone]


def _remove_entries(overlay: Overlay, entries: list[Path], fault: Path) -> None:
    """Take entries away, with the excitations and links of what is in them."""
    gone = {
        part.name: part
        for part in overlay.study.train.parts
        if any(part.path[: len(entry)] == entry for entry in entries)
    }
    if overlay.study.reference in gone:
        message = f"'{overlay.study.reference}', the reference of all speeds, is removed too"
        overlay.faults.append(
            Fault(fault, message, "keep it, or state another in `operation: {at: ...}` of the file")
        )
        return
    stated: dict[Path, dict[str, Any]] = {  # an excitation has `at`, a link `between`
        (section, number): body
        for section in ("links", "excitations")
        for number, body in entries_of(overlay.source.data.get(section))
        if isinstance(body, dict)
    }
    acting = [path for path, body in stated.items() if body.get("at") in gone]
    links = [
        path
        for path, body in stated.items()
        if {*map(str, body.get("between") or ())} & gone.keys()
    ]
    entries = [*entries, *links, *acting]
    gone |= {part.name: part for part in overlay.study.train.parts if part.path[:2] in links}
    # Components without a name keep that which kind and number give them with all components there.
    kinds = {part.kind for part in gone.values()}
    for part in overlay.study.train.parts:
        if part.path[-1] == part.kind in kinds and not part.is_named and part.name not in gone:
            node = overlay.source.at(part.path) or overlay.source.root
            named = Node(part.name, node.line, node.column, source=node.source)
            overlay.put((*part.path, "name"), named)
    overlay.removed |= dict.fromkeys(entries)
    with_it = [f"{len(acting)} excitation{'s' * (len(acting) > 1)}"] if acting else []
    words = ", ".join([*gone, *with_it])
    overlay.changes.append(Change("components and what acts on them", words, "taken away"))


def stiffness_paths(overlay: Overlay, part: Part) -> Iterator[Path]:
    """Yield where the file states the stiffnesses, or the flexibility, of a coupling."""
    source = overlay.source
    for keys in STIFFNESSES:
        if source.at((*part.path, *keys)) is not None:
            yield (*part.path, *keys)
    for keys, entry_path in LISTED:
        rows = source.at((*part.path, *keys))
        for step, _ in entries_of(None if rows is None else rows.value):
            yield (*part.path, *keys, step, *entry_path)
