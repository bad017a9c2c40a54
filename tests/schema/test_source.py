"""YAML text as data with places: core rules of YAML 1.2, columns counted by hand, refusals in words."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.for_all import for_all
from tests.texts import ANY_CHARACTER

from torsion.errors import InputError
from torsion.schema import yaml_source as source
from torsion.schema.yaml_source import Source, parse_source, read_source, resolved

SCENE = """\
# a comment
name: Unmanned boat
train:
  - motor: {inertia: 1.2 kg*m**2}
  - coupling:
      stiffness: 20 kN*m/rad
      rated_torque: "1.0 kN*m"
  - engine:
      inertia: [1, 2.5,
                3]
      note: |
        two
        lines
rules:
- iacs-m68
- gear-hammer: {limit: 0.35}
modes:
"""


@pytest.fixture(params=["libyaml", "python"])
def parser(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both parsers of PyYAML: the one in C is not on every machine."""
    monkeypatch.setattr(
        source, "_LOADER", yaml.SafeLoader if request.param == "python" else source._LOADER
    )


@for_all(
    ("text", "value"),
    [
        ("1e6", 1e6),
        ("1.0E+6", 1e6),
        ("1e-3", 1e-3),
        ("2_000", 2000),
        ("2_000.5", 2000.5),
        (".5", 0.5),
        ("5.", 5.0),
        ("-3", -3),
        ("+3", 3),
        ("-.5e1", -5.0),
        ("0", 0),
        ("007", 7),
        ("0x1F", 31),
        ("0o17", 15),
        ("5.e2", 500.0),
        ("true", True),
        ("True", True),
        ("TRUE", True),
        ("false", False),
        ("False", False),
        ("FALSE", False),
        ("null", None),
        ("Null", None),
        ("NULL", None),
        ("~", None),
        ("", None),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("+.Inf", math.inf),
        ("1e400", math.inf),
        ("9" * 400, math.inf),
        ("0x" + "F" * 5000, math.inf),
        ("12345678901234567890", 12345678901234567890),
    ],
)
def test_a_plain_scalar_is_what_the_core_rules_say(text: str, value: Any) -> None:
    assert resolved(text) == value
    assert (isinstance(resolved(text), type(value)) and not isinstance(value, bool)) or resolved(
        text
    ) is value


@pytest.mark.parametrize("text", [".nan", ".NaN", ".NAN"])
def test_not_a_number_is_read_and_left_to_the_limits_of_its_key(text: str) -> None:
    assert math.isnan(resolved(text))  # type: ignore[arg-type]


@for_all(
    "text",
    [
        "no",
        "yes",
        "on",
        "off",
        "y",
        "n",
        "No",
        "tRUE",
        "nULL",
        "1:30",
        "190:20:30",
        "2024-01-31",
        "1__0",
        "_1",
        "1_",
        "0b11",
        "0X1F",
        "-0x1F",
        "e5",
        ".",
        "-",
        "+",
        ".e5",
        "1e",
        "nan",
        "inf",
        "١٢",
        "1 kN",
        "<",
        "2024-01-31 10:00:00",
    ],
)
def test_everything_else_is_text(text: str) -> None:
    assert resolved(text) == text


@pytest.mark.usefixtures("parser")
@pytest.mark.parametrize("quoted", ["'1e6'", '"1e6"', "|-\n 1e6", ">-\n 1e6"])
def test_quoted_text_stays_text(quoted: str) -> None:
    assert parse_source(f"a: {quoted}\nb: 'no'", "f").data == {"a": "1e6", "b": "no"}


@pytest.mark.usefixtures("parser")
def test_a_scene_is_plain_data() -> None:
    read = parse_source(SCENE, "scene.yaml")
    assert read.name == "scene.yaml"
    assert read.text == SCENE
    assert read.lines[1] == "name: Unmanned boat"
    assert read.data == {
        "name": "Unmanned boat",
        "train": [
            {"motor": {"inertia": "1.2 kg*m**2"}},
            {"coupling": {"stiffness": "20 kN*m/rad", "rated_torque": "1.0 kN*m"}},
            {"engine": {"inertia": [1, 2.5, 3], "note": "two\nlines\n"}},
        ],
        "rules": ["iacs-m68", {"gear-hammer": {"limit": 0.35}}],
        "modes": None,
    }


@pytest.mark.usefixtures("parser")
@for_all(
    ("path", "value", "key"),
    [
        ((), (2, 1), (2, 1)),
        (("name",), (2, 7), (2, 1)),
        (("train",), (4, 3), (3, 1)),
        (("train", 0), (4, 5), (4, 5)),
        (("train", 0, "motor"), (4, 12), (4, 5)),
        (("train", 0, "motor", "inertia"), (4, 22), (4, 13)),
        (("train", 1, "coupling"), (6, 7), (5, 5)),
        (("train", 1, "coupling", "stiffness"), (6, 18), (6, 7)),
        (("train", 1, "coupling", "rated_torque"), (7, 21), (7, 7)),
        (("train", 2, "engine", "inertia"), (9, 16), (9, 7)),
        (("train", 2, "engine", "inertia", 1), (9, 20), (9, 20)),
        (("train", 2, "engine", "inertia", 2), (10, 17), (10, 17)),
        (("train", 2, "engine", "note"), (11, 13), (11, 7)),
        (("rules", 0), (15, 3), (15, 3)),
        (("rules", 1, "gear-hammer", "limit"), (16, 24), (16, 17)),
        (("modes",), (17, 7), (17, 1)),
    ],
)
def test_every_path_has_the_place_of_its_value_and_of_its_key(
    path: Any, value: Any, key: Any
) -> None:
    read = parse_source(SCENE, "f")
    assert read.find(path)[1] == value
    assert read.find(path, key=True)[1] == key


@pytest.mark.parametrize(
    ("path", "parent"),
    [
        (("excitations",), ()),
        (("train", 0, "motor", "power"), ("train", 0, "motor")),
        (("train", 0, "motor", "inertia", "deeper", 3), ("train", 0, "motor", "inertia")),
        (("train", 9, "shaft", "length"), ("train",)),
        (("train", "motor"), ("train",)),
        (("modes", "count"), ("modes",)),
    ],
)
def test_what_is_missing_has_the_place_of_the_nearest_parent(path: Any, parent: Any) -> None:
    read = parse_source(SCENE, "f")
    assert read.find(path)[1] == read.find(parent)[1]
    assert read.find(path, key=True)[1] == read.find(parent, key=True)[1]


@pytest.mark.usefixtures("parser")
@for_all(
    ("text", "path", "place"),
    [
        ("a: 1\r\nb: 2\r\n", ("b",), (2, 4)),
        ("a: é\nb: [ö, 1]", ("b", 1), (2, 8)),
        ("a: 😀 x\nb: {'😀': 1}", ("b", "😀"), (2, 10)),
        ("- - 1\n  - 2\n-\n  - 3", (0, 1), (2, 5)),
        ("- - 1\n  - 2\n-\n  - 3", (1, 0), (4, 5)),
        ("? a\n: 1", ("a",), (2, 3)),
        ("? a", ("a",), (1, 4)),
        ("--- \na:\n   - {b:\n 1}", ("a", 0, "b"), (4, 2)),
        ("a: &x {c: 1}\nb: *x", ("b",), (2, 4)),
        ("a: &x {c: 1}\nb: *x", ("b", "c"), (1, 11)),
    ],
)
def test_columns_count_characters(text: str, path: Any, place: Any) -> None:
    assert parse_source(text, "f").find(path)[1] == place


@pytest.mark.usefixtures("parser")
@for_all(
    ("text", "place", "words"),
    [
        ("a: 1\nb: 2\na: 3", (3, 1), "the key 'a' is already in line 1"),
        ("- x: {b: 1, b: 2}", (1, 13), "the key 'b' is already in line 1"),
        ("a: 1\n'a': 3", (2, 1), "the key 'a' is already in line 1"),
        ("a: 1\n3: 2", (2, 1), "the key 3 is not text"),
        ("a: {true: 2}", (1, 5), "the key true is not text"),
        ("? \n: 2", (1, 2), "is not text"),
        ("? [a]\n: 1", (1, 3), "a key must be text"),
        ("a: &x 1\n? *x\n: 1", (2, 3), "a key must be text"),
        ("a: &x {b: 1}\nc:\n  <<: *x", (3, 3), "merge keys (<<) are not read"),
        (
            "a: !!python/object/apply:os.system ['ls']",
            (1, 4),
            "tags are not read: !!python/object/apply:os.system",
        ),
        ("a: !own 1", (1, 4), "tags are not read: !own"),
        ("a: !!str 1", (1, 4), "tags are not read: !!str"),
        ("a: !<x 1", (1, 7), "tags (!) are not read"),
        ("a: !no!x 1", (1, 4), "tags (!) are not read"),
        ("a: 1\n---\nb: 1", (2, 1), "a second document begins here"),
        ("a: *x", (1, 4), "nothing above is named &x"),
        ("a: &x [1, *x]", (1, 11), "*x lies within the part that it repeats"),
        ("a: &x\n  b: {c: *x}", (2, 10), "*x lies within the part that it repeats"),
        ("[" * 60, (1, 51), "more than 50 lists and mappings within each other"),
        ("- " * 5000, (1, 101), "more than 50 lists and mappings within each other"),
        ("{a: " * 60, (1, 201), "more than 50 lists and mappings within each other"),
        ("a: 1\n\tb: 2", (2, 1), "a tab is used for indentation"),
        ("a: b: c", (1, 5), "a ':' is not allowed here"),
        ("a: 1\n  b: 2", (2, 4), "a ':' is not allowed here"),
        (
            "x:\n  - a: {b: 1\n  - c: {d: 2}",
            (2, 8),
            "no closing '}' for this bracket, or no comma before line 3",
        ),
        ("a: [1, 2", (1, 4), "no closing ']' for this bracket"),
        ("a:\n  'abc\n\n", (2, 3), "this quote is not closed"),
        ("a: 'b\n---\n", (1, 4), "this quote is not closed"),
        ("- a\nb: 1", (2, 1), "this does not fit the lines above"),
        ("a:\n  - b\n c: 1", (3, 2), "this does not fit the lines above"),
        ("a: @x", (1, 4), "a value cannot begin with this character"),
        ("a: - b", (1, 4), "a list cannot begin here"),
        ("a: ]", (1, 4), "a value is missing in front of this"),
        ("[a]]", (1, 4), "this belongs to nothing before it"),
        ("a: &", (1, 5), "a name is missing after '&' or '*'"),
        ("a: |x\n b", (1, 5), "nothing may follow '|' or '>'"),
        ("%YAML 2.0\n---\na", (1, 1), "lines that begin with % are not read"),
        ("a: \x07", (1, 4), "the character U+0007 is not allowed"),
        ("a: 1\r\nb: \x00", (2, 4), "the character U+0000 is not allowed"),
        ("a: \ud800", (1, 4), "the character U+D800 is not allowed"),
        ("a\ufeffb: 1", (1, 2), "there is a byte order mark (U+FEFF) here"),
        ("", (1, 1), "the file is empty"),
        ("# nothing\n\n", (1, 1), "the file is empty"),
        ("---\n...\n", (1, 1), "the file is empty"),
    ],
)
def test_what_cannot_be_read_is_refused_at_its_place(
    text: str, place: tuple[int, int], words: str
) -> None:
    fault = _refused(text).faults[0]
    assert words in fault.message
    assert (fault.line, fault.column) == place


def test_an_escape_that_means_nothing_is_refused() -> None:
    assert "the backslash stands for no character here" in str(_refused('a: "\\q"'))


@pytest.mark.usefixtures("parser")
def test_all_faults_are_told_at_once_with_the_lines_quoted() -> None:
    error = _refused("a: 1\na: !x 2\n3: [4\n")
    assert str(error) == (
        "f:2:1: the key 'a' is already in line 1 (remove one)\n    a: !x 2\n    ^\n\n"
        "f:2:4: tags are not read: !x (remove it, or put text in quotes)\n    a: !x 2\n       ^\n\n"
        "f:3:1: the key 3 is not text (put it in quotes)\n    3: [4\n    ^\n\n"
        f"f:3:4: no closing ']' for this bracket, or no comma before {_end_of_text()}\n    3: [4\n       ^"
    )


@pytest.mark.usefixtures("parser")
def test_an_alias_repeats_a_value() -> None:
    assert parse_source("a: &x [1, {b: &y 2}]\nc: *x\nd: *y", "f").data == {
        "a": [1, {"b": 2}],
        "c": [1, {"b": 2}],
        "d": 2,
    }


@pytest.mark.usefixtures("parser")
def test_a_merge_sign_in_quotes_is_a_key() -> None:
    assert parse_source("'<<': 1", "f").data == {"<<": 1}


def test_aliases_that_blow_up_are_refused() -> None:
    rows = ["a0: &a0 [" + ", ".join("x" * 10) + "]"]
    rows += [f"a{n}: &a{n} [" + ", ".join([f"*a{n - 1}"] * 10) + "]" for n in range(1, 30)]
    assert "aliases make more than 100000 values" in str(_refused("\n".join(rows)))


def test_aliases_that_go_deep_are_refused() -> None:
    rows = ["a0: &a0 []"] + [f"a{n}: &a{n} [*a{n - 1}]" for n in range(1, 100)]
    fault = _refused("\n".join(rows)).faults[0]
    assert fault.message == "more than 50 lists and mappings within each other"
    assert (
        fault.line == 50
    )  # a0 is one list, so a48 is 49 within each other, and the top level is one more


def test_only_what_aliases_add_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(source, "_LARGEST", 1000)
    assert len(parse_source("[" + "1," * 2000 + "]", "f").data) == 2000
    assert "aliases make more than 1000 values" in str(_refused("- &x [" + "1," * 600 + "]\n- *x"))


def test_a_byte_order_mark_at_the_beginning_is_no_part_of_the_text(tmp_path: Path) -> None:
    path = tmp_path / "f.yaml"
    path.write_bytes("a: 1".encode("utf-8-sig"))
    source = read_source(path)
    assert source.data == {"a": 1}
    assert source.find(("a",))[1] == (1, 4)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (
            b"name: \xff\xfe",
            "f.yaml:1:7: the file is not UTF-8 text (save it as UTF-8)\n    name: ",
        ),
        (b"a: 1\nname: caf\xe9\n", "f.yaml:2:10: the file is not UTF-8 text"),
        ("a: 1".encode("utf-16"), "f.yaml:1:1: the file is not UTF-8 text"),
        (b"", "f.yaml:1:1: the file is empty"),
    ],
)
def test_a_file_that_is_not_text_is_refused(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "f.yaml"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_source(path)
    assert words in str(caught.value)


def test_a_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "f.yaml"
    path.write_bytes("name: größe\r\n".encode())
    read = read_source(str(path))
    assert isinstance(read, Source)
    assert (read.name, read.data) == (str(path), {"name": "größe"})


@pytest.mark.parametrize(
    ("name", "words"),
    [("none", "the file does not exist"), (".", "a folder"), ("\0", "cannot be read")],
)
def test_a_path_that_is_no_file_is_refused(name: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words) as caught:
        read_source(tmp_path / name)
    assert caught.value.faults[0].path == ()


def test_a_source_is_frozen() -> None:
    with pytest.raises(AttributeError):
        parse_source("a: 1", "f").name = "g"  # type: ignore[misc]


PIECES = st.sampled_from(
    [
        "a",
        "b: ",
        ": ",
        "- ",
        "\n",
        "\n  ",
        "\t",
        "[",
        "]",
        "{",
        "}",
        ",",
        "'",
        '"',
        "|",
        ">",
        "&x ",
        "*x",
        "!",
        "#",
        "%",
        "@",
        "? ",
        "---\n",
        "...\n",
        "<<: ",
        "1",
        "0x",
        "\\",
        "~",
        "é",
        "!!int ",
        "\r",
        "\x85",
        "\u2028",
        "\ufeff",
        "\0",
    ]
)


@settings(max_examples=120, deadline=None, derandomize=True)
@given(text=st.text(ANY_CHARACTER, max_size=30) | st.lists(PIECES, max_size=15).map("".join))
@example(text="&a [" + "*a," * 3 + "]")
def test_any_text_is_data_with_places_or_an_input_error(text: str) -> None:
    try:
        read = parse_source(text, "f")
    except InputError as error:
        faults = error.faults
        lines = Source("", text).lines
        assert faults
        assert all(fault.message.isprintable() for fault in faults)
        assert all(1 <= (fault.line or 0) <= len(lines) for fault in faults)
        assert all(
            1 <= (fault.column or 0) <= len(lines[(fault.line or 0) - 1]) + 1 for fault in faults
        )
    else:
        _walk(read, read.data, ())


def _walk(read: Source, value: Any, path: tuple[str | int, ...]) -> None:
    line, column = read.find(path)[1]
    assert 1 <= line <= len(read.lines)
    assert 1 <= column <= len(read.lines[line - 1]) + 1
    for step, part in (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    ):
        _walk(read, part, (*path, step))


def _refused(text: str) -> InputError:
    with pytest.raises(InputError) as caught:
        parse_source(text, "f")
    return caught.value


def _end_of_text() -> str:
    """Where the two parsers give up on 'a: 1 ... 3: [4': behind the last line break."""
    return "line 4, column 1"
