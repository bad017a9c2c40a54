"""The example that `torsion new` writes."""

from importlib.resources import files


def example() -> str:
    """The text of a scene that explains every key and solves as it stands."""
    return files("torsion.schema").joinpath("templates", "example.yaml").read_text(encoding="utf-8")
