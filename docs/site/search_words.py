"""The index for the search: the stem of a word is computed once for all pages, as Sphinx does for each page anew."""

from functools import cache

from sphinx.application import Sphinx
from sphinx.search.en import SearchEnglish


def setup(app: Sphinx) -> dict[str, bool]:
    """Take the place of the English of Sphinx."""
    app.add_search_language(English)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


class English(SearchEnglish):
    """With a memory."""

    def stem(self, word: str) -> str:
        """Return the stem of a word."""
        return STEM(word)


STEM = cache(SearchEnglish({}).stem)
