"""PyInstaller reads ``hiddenimports`` and ``datas`` here when a program imports irsim."""

from __future__ import annotations

from PyInstaller.utils.hooks import collect_data_files, collect_submodules

# Names are imported when they are first used, so no file names the modules behind them.
hiddenimports = collect_submodules("irsim", filter=lambda name: not name.startswith("irsim.compat.freezing"))
hiddenimports += collect_submodules("isal")  # its modules written in C import one another
datas = collect_data_files("irsim", include_py_files=False)
