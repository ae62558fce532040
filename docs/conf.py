"""How the site is built: `sphinx-build -W docs build/docs`. Needs no network."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "build_helpers"))

import figures  # noqa: E402
import generated  # noqa: E402
from gallery import draw, names  # noqa: E402  # not as `gallery`, which is a config value

from designer import __version__  # noqa: E402

project = "cdpr-designer"
author = "the cdpr-designer contributors"
project_copyright = author
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "mathml"]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
exclude_patterns = ["build_helpers", "_gallery"]
generated.GALLERY.mkdir(parents=True, exist_ok=True)  # before Sphinx asks for it
html_extra_path = ["_gallery"]  # the reports, as they are

default_role = "code"  # numpydoc texts write `names` so
numpydoc_show_class_members = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the parameters' docs say units and shapes, which types do not
autodoc_preserve_defaults = True  # as they stand in the code, not what they hold

html_theme = "pydata_sphinx_theme"
html_title = f"cdpr-designer {release}"
html_static_path = ["_static"]
html_css_files = ["own.css"]
html_show_sourcelink = False
html_sidebars = {"tutorial": [], "gallery": []}  # the only pages of their sections
html_theme_options = {
    "navigation_with_keys": False,
    "show_prev_next": True,
    # none beside the widest tables
    "secondary_sidebar_items": {"**": ["page-toc"], "explanation/peers": []},
    "footer_end": [],
}
html_math_renderer = "mathml"


def setup(app):
    """Fill the pages that are made from the code, and draw the figures."""
    app.connect("builder-inited", lambda app: figures.draw_all(HERE / "explanation" / "figures"))
    app.add_config_value("gallery", names(), "env")  # as -D gallery=yard,stadium
    app.connect("builder-inited", lambda app: draw(generated.GALLERY, app.config.gallery))
    app.connect("env-get-outdated", lambda *_: ["gallery"])  # though its own text is as it was
    app.connect("source-read", generated.fill)
