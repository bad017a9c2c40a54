"""Any text, for tests by hypothesis."""

from hypothesis import strategies as st

# The characters that `st.text()` draws by default: all that UTF-8 can write. It finds them by writing each of them,
# which takes seconds in every process of a fresh checkout; their category says the same.
ANY_CHARACTER = st.characters(exclude_categories=["Cs"])
