"""Title, first sentence and example of every analysis and rule: templates/titles.txt and setting_examples.txt."""

from functools import cache

from torsion.schema import template


@cache
def titles() -> dict[str, tuple[str, str]]:
    """Return title and first sentence of the page of every analysis and rule by its name."""
    lines = template("titles.txt").splitlines()
    rows = (line.split(" | ") for line in lines if not line.startswith("#"))
    return {name: (title, sentence) for name, title, sentence in rows}


@cache
def setting_examples() -> dict[str, str]:
    """Return an example of the settings of every analysis and rule by its name."""
    examples = template("setting_examples.txt").strip().split("\n\n")
    return {example.partition(":")[0]: example for example in examples}
