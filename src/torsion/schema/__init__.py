"""The file of a shaft train: read with the place of every fault; its JSON Schema and an example."""

from importlib.resources import files


def template(name: str) -> str:
    """A text of the folder `templates`: `example.yaml`, which solves as it stands, or `manual.md`."""
    return files("torsion.schema").joinpath("templates", name).read_text(encoding="utf-8")
