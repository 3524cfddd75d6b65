"""How Sphinx lays out the Markdown that ``build.py`` writes."""

import os

project = "irsim"
release = version = os.environ["IRSIM_SITE_RELEASE"]
author = "irsim developers"
project_copyright = author
extensions = ["myst_parser"]
myst_heading_anchors = 4
myst_links_external_new_tab = False
source_suffix = {".md": "markdown"}
exclude_patterns = ["players"]
highlight_language = "text"
smartquotes = False
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
html_theme = "pydata_sphinx_theme"
html_title = "irsim"
html_static_path = ["static"]
html_css_files = ["irsim.css"]
html_favicon = "static/favicon.svg"
html_search_scorer = os.environ["IRSIM_SITE_SCORER"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_last_updated_fmt = None
html_permalinks = True
html_use_index = False
html_sidebars = {"index": [], "gallery/**": [], "search": []}
html_context = {"default_mode": "auto"}
html_theme_options = {
    "logo": {"text": "irsim"},
    "show_toc_level": 2,
    "navigation_depth": 3,
    "show_nav_level": 1,
    "collapse_navigation": True,
    "header_links_before_dropdown": 9,
    "navbar_align": "left",
    "navbar_end": ["version-switcher", "theme-switcher"],
    "footer_start": ["footer"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "show_prev_next": True,
    "check_switcher": False,
    "switcher": {
        "json_url": os.environ.get("IRSIM_SITE_SWITCHER", "_static/switcher.json"),
        "version_match": os.environ.get("IRSIM_SITE_VERSION", "dev"),
    },
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
templates_path = ["templates"]
