"""What a case takes away of a train: a component with all that it carries, and what acts on it or joins it."""

from collections.abc import Sequence

from torsion.errors import Fault, Path, printable
from torsion.model.parts import Part
from torsion.schema.fault_text import Node
from torsion.schema.overlay import Overlay, in_words, node_at, of_list
from torsion.study import Change

MAIN = ("train",)


def remove_components(overlay: Overlay, names: Sequence[str], fault: Path) -> None:
    """Take components, or keys, away by their names; `fault` is the place of the list of names."""
    parts = {part.name: part for part in overlay.parts}
    entries: dict[Path, None] = {}  # of the lists of components
    ends: dict[Path, Path] = {}  # entry of the main train that a name stands for: where it is named
    stated = node_at(overlay.source.root, fault)
    for position, name in enumerate(names):
        # A name stands in a list, or alone.
        is_list = stated is not None and isinstance(stated.value, list)
        fault_path = (*fault, position) if is_list else fault
        if name in parts:
            path = parts[name].path[:-1]
            if path[:-1] == MAIN and parts[name].kind != "branch":
                ends[path] = fault_path
            else:
                entries |= dict.fromkeys(_branch_entries(overlay, path, parts[name]))
        elif (key_path := overlay.path(name, fault_path)) is not None and "." in name:
            given = node_at(overlay.source.root, key_path)
            if given is None:
                message = f"`{printable(name)}` is not given: nothing changes"
                overlay.faults.append(Fault(fault_path, message, "leave it out"))
            else:
                overlay.changes.append(Change(name, in_words(given.value), "not given"))
                overlay.remove(key_path)
    entries |= dict.fromkeys(_main_entries(overlay, ends))
    if not overlay.faults and entries:
        _remove_entries(overlay, list(entries), fault)


def _branch_entries(overlay: Overlay, path: Path, part: Part) -> list[Path]:
    """The entries that go with one outside the main train: of a branch all behind it, and itself where none is left."""
    if path[0] == "links" or part.kind == "branch":
        return [path]
    line, position = path[:-1], path[-1]
    if position == 0 and line[-2] == "branch":
        return [line[:-2]]
    size = len((node_at(overlay.source.root, line) or Node([], 1, 1)).value)
    return [(*line, k) for k in range(int(position), size)]


def _main_entries(overlay: Overlay, ends: dict[Path, Path]) -> list[Path]:
    """The entries of the main train that are named, from one of its ends on, with the branches that they carry."""
    if not ends:
        return []
    body = (node_at(overlay.source.root, MAIN) or Node([], 1, 1)).value
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

    def goes(part: Part) -> bool:
        return any(part.path[: len(entry)] == entry for entry in entries)

    gone = {part.name: part for part in overlay.parts if goes(part)}
    if overlay.reference in gone:
        message = f"'{overlay.reference}', the reference of all speeds, is removed too"
        overlay.faults.append(
            Fault(fault, message, "keep it, or state another in `operation: {at: ...}` of the file")
        )
        return
    data = overlay.source.data
    links = {
        k: body
        for k, body in of_list(data, "links")
        if set(map(str, body.get("between") or ())) & set(gone)
    }
    acting = [k for k, body in of_list(data, "excitations") if body.get("at") in gone]
    entries = [*entries, *(("links", k) for k in links), *(("excitations", k) for k in acting)]
    gone |= {part.name: part for part in overlay.parts if goes(part)}
    # Components without a name keep that which kind and number give them with all components there.
    kinds = {part.kind for part in gone.values()}
    for part in overlay.parts:
        if part.path[-1] == part.kind in kinds and not part.is_named and part.name not in gone:
            node = node_at(overlay.source.root, part.path) or overlay.source.root
            place = node.line, node.column
            overlay.put((*part.path, "name"), Node(part.name, *place, source=node.source), place)
    for entry in entries:
        overlay.remove(entry)
    with_it = [f"{len(acting)} excitation{'s' * (len(acting) > 1)}"] if acting else []
    words = ", ".join([*gone, *with_it])
    overlay.changes.append(Change("components and what acts on them", words, "taken away"))
