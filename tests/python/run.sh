#!/bin/sh
# run.sh SOURCE_FOLDER MOTEHOUND: of the tests on tools/ those that call the command, or skipped (77) where their environment is absent. Without the sweeps and
# the tests in a browser: what a build can change in them shows in the others; tools/test python runs all.
python=$1/.deps/venv/bin/python
if ! "$python" -c 'import bokeh, distributed, jinja2, lcm, matplotlib, mcap, pyarrow, pydantic, pytest, rich, ruamel.yaml, scipy' 2>/dev/null; then
    echo "skipped: $python does not have the packages of tools/requirements.txt; run tools/setup"
    exit 77
fi
cd "$1/tools" && MOTEHOUND=$2 PYTHONDONTWRITEBYTECODE=1 exec "$python" -m pytest -q -p no:cacheprovider -m "not browser and not sweep" \
    tests/test_export.py tests/test_metec.py tests/test_recording.py tests/test_results.py tests/test_sweep.py tests/test_report.py::test_experiments_of_this_repository \
    tests/test_report.py::test_page_of_clusters tests/test_report.py::test_page_of_searches_and_fixed_clusters tests/test_report.py::test_page_of_a_target_that_is_heard
