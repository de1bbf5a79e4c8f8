"""How Sphinx builds the site: python -m sphinx -W --keep-going -n -b html docs build/site.

Nothing of the pages is run here: their code blocks are tests (tests/docs), their pictures lie
beside them (docs/pictures.py).
"""

from __future__ import annotations

from importlib.metadata import version as version_of

project = "splinesdf"
author = copyright = "the splinesdf developers"  # noqa: A001
version = release = version_of("splinesdf")

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
exclude_patterns = ["pictures"]
html_extra_path = ["explorer"]

# GitHub's names of headings, so that a link works there and here.
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]

# Names in single backticks are ours; a type of NumPy's is not looked up, as that needs a network.
default_role = "py:obj"
nitpicky = True
autodoc_member_order = "bysource"
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

html_theme = "furo"
html_title = "splinesdf"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False


def _escape_bars(_app, _what, _name, _object, _options, lines):  # type: ignore[no-untyped-def]
    """Docstrings write |s - u| for an absolute value, which is a substitution to Sphinx."""
    for k, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            parts = line.split("``")
            parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
            lines[k] = "``".join(parts)


def setup(app):  # type: ignore[no-untyped-def]
    """Sphinx calls this."""
    # Before numpydoc, whose own sections would be touched otherwise.
    app.connect("autodoc-process-docstring", _escape_bars, priority=400)
