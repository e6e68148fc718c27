#!/bin/sh
# run.sh SOURCE_FOLDER MOTEHOUND: pytest on tools/, or skipped (77) where its environment is absent. Without the sweeps and the tests in a
# browser: what a build can change in them shows in the others; tools/test python runs all.
python=$1/.deps/venv/bin/python
if ! "$python" -c 'import bokeh, distributed, jinja2, lcm, matplotlib, mcap, pyarrow, pydantic, pytest, rich, ruamel.yaml, scipy' 2>/dev/null; then
    echo "skipped: $python does not have the packages of tools/requirements.txt; run tools/setup"
    exit 77
fi
cd "$1/tools" && MOTEHOUND=$2 PYTHONDONTWRITEBYTECODE=1 exec "$python" -m pytest -q -p no:cacheprovider -m "not browser and not sweep" tests
