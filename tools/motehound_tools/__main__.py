"""python -m motehound_tools report | sweep | results | zhou | xu | zhang | han | metec | faults | picture | bound | export | view"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .failure import Failure


def parser() -> argparse.ArgumentParser:
    top = argparse.ArgumentParser(
        prog="motehound_tools", description="Reports, sweeps and reference figures for motehound."
    )
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")

    report = commands.add_parser("report", help="one HTML page of a run's results, or of those of sweeps")
    report.add_argument("folder", type=Path, metavar="OUT_DIR")
    report.add_argument("--html", type=Path, help="the page to write (OUT_DIR/report.html)")

    sweep = commands.add_parser("sweep", help="run what is missing of an experiment and write its table")
    sweep.add_argument("experiment", type=Path, metavar="EXPERIMENT.yaml")
    sweep.add_argument("--out", type=Path, help="the folder (out/EXPERIMENT)")
    sweep.add_argument("--seeds", metavar="SEEDS", help="such as 0-19 or 3,5,8, instead of the experiment's")
    sweep.add_argument("--jobs", type=int, metavar="N", help="runs at the same time on this machine (its processors)")
    sweep.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask cluster that does the runs, such as tcp://host:8786"
    )

    results = commands.add_parser("results", help="run the published experiments and write the table of results")
    results.add_argument("--quick", action="store_true", help="5 seeds instead of 50")
    results.add_argument(
        "--out", type=Path, default=Path("out/results"), help="where the runs go; finished ones are kept"
    )
    results.add_argument(
        "--markdown", type=Path, help="the page to write (docs/results.md; with --quick out/results-quick.md)"
    )

    zhou = commands.add_parser("zhou", help="run the experiments zhou_* and write the page about them")
    zhou.add_argument("--seeds", metavar="SEEDS", help="such as 0-2, instead of the experiments' own")
    zhou.add_argument("--out", type=Path, default=Path("out/zhou"), help="where the sweeps go; finished runs are kept")
    zhou.add_argument("--markdown", type=Path, default=Path("docs/zhou.md"), help="the page to write")

    xu = commands.add_parser("xu", help="run the experiments xu_* and write the page about them")
    xu.add_argument("--seeds", metavar="SEEDS", help="such as 0-9, instead of the experiments' own")
    xu.add_argument("--out", type=Path, default=Path("out/xu"), help="where the sweeps go; finished runs are kept")
    xu.add_argument("--markdown", type=Path, default=Path("docs/xu.md"), help="the page to write")

    zhang = commands.add_parser("zhang", help="run the experiments zhang_* and write the page about them")
    zhang.add_argument("--seeds", metavar="SEEDS", help="such as 0-9, instead of the experiments' own")
    zhang.add_argument("--out", type=Path, default=Path("out/zhang"), help="where the sweeps go; finished runs are kept")
    zhang.add_argument("--markdown", type=Path, default=Path("docs/zhang.md"), help="the page to write")

    han = commands.add_parser("han", help="run the experiments han_* and write the page about them")
    han.add_argument("--seeds", metavar="SEEDS", help="such as 0-9, instead of the experiments' own")
    han.add_argument("--out", type=Path, default=Path("out/han"), help="where the sweeps go; finished runs are kept")
    han.add_argument("--markdown", type=Path, default=Path("docs/han.md"), help="the page to write")

    metec = commands.add_parser("metec", help="replay the real leaks and write the page about them")
    metec.add_argument("data", type=Path, metavar="FOLDER_OF_THE_RECORDING")
    metec.add_argument("--out", type=Path, default=Path("out/metec"), help="where the recordings and replays go")
    metec.add_argument("--markdown", type=Path, default=Path("docs/metec.md"), help="the page to write")

    faults = commands.add_parser("faults", help="run the scenarios of faults and write the table of faults")
    faults.add_argument("--runs", type=int, default=20)
    faults.add_argument(
        "--out", type=Path, default=Path("out/faults"), help="where the runs go; finished ones are kept"
    )
    faults.add_argument("--markdown", type=Path, default=Path("docs/faults.md"), help="the page to write")

    picture = commands.add_parser("picture", help="draw the README's picture of a tracked source")
    picture.add_argument("--out", type=Path, default=Path("out/picture"), help="where the runs go")
    picture.add_argument("--image", type=Path, default=Path("docs/images/tracked_source.svg"))

    bound = commands.add_parser("bound", help="posterior Cramer-Rao bound of an output folder's scenario")
    bound.add_argument("folder", type=Path, metavar="OUT_DIR")
    bound.add_argument("--seeds", type=int, default=4, help="deployments to average over")

    export = commands.add_parser("export", help="an LCM log as CSV, MCAP or rerun's recording")
    export.add_argument("log", type=Path, metavar="LOG.lcm")
    export.add_argument("--to", required=True, choices=["csv", "mcap", "rerun"])
    export.add_argument("out", type=Path, metavar="OUT", help="a file; for csv a folder, one file a channel")

    view = commands.add_parser("view", help="a page on localhost that shows an LCM log, or what is on the bus")
    shown = view.add_mutually_exclusive_group(required=True)
    shown.add_argument("log", type=Path, nargs="?", metavar="LOG.lcm")
    shown.add_argument("--bus", metavar="URL", help="such as udpm://239.255.76.67:7667?ttl=0")
    view.add_argument("--port", type=int, default=5006, help="0: any that is free (%(default)s)")

    for one in (sweep, results, zhou, xu, zhang, han, metec, faults, picture):
        one.add_argument("--motehound", help="the program (else $MOTEHOUND, build/host, PATH)")
    return top


def perform(arguments: argparse.Namespace) -> None:
    # Each part is imported when it is asked for: drawing alone takes a second to load.
    if arguments.command == "report":
        from . import report

        page = arguments.html or arguments.folder / "report.html"
        report.write(arguments.folder, page)
        print(page)
    elif arguments.command == "sweep":
        from . import sweep

        if arguments.jobs is not None and (arguments.jobs < 1 or arguments.scheduler):
            raise Failure("--jobs: expected 1 or more, and no --scheduler, whose workers decide for themselves")
        chosen = (arguments.out, arguments.seeds, arguments.jobs, arguments.scheduler, arguments.motehound)
        print(sweep.run(arguments.experiment, *chosen) / "table.csv")
    elif arguments.command == "results":
        from . import command, results

        page = arguments.markdown or Path("out/results-quick.md" if arguments.quick else "docs/results.md")
        results.write(command.find(arguments.motehound), arguments.out, page, 5 if arguments.quick else 50)
        print(page)
    elif arguments.command == "zhou":
        from . import zhou

        zhou.write(arguments.motehound, arguments.out, arguments.markdown, arguments.seeds)
        print(arguments.markdown)
    elif arguments.command == "xu":
        from . import xu

        xu.write(arguments.motehound, arguments.out, arguments.markdown, arguments.seeds)
        print(arguments.markdown)
    elif arguments.command == "zhang":
        from . import zhang

        zhang.write(arguments.motehound, arguments.out, arguments.markdown, arguments.seeds)
        print(arguments.markdown)
    elif arguments.command == "han":
        from . import han

        han.write(arguments.motehound, arguments.out, arguments.markdown, arguments.seeds)
        print(arguments.markdown)
    elif arguments.command == "metec":
        from . import command, metec

        metec.write(command.find(arguments.motehound), arguments.data, arguments.out, arguments.markdown)
        print(arguments.markdown)
    elif arguments.command == "faults":
        from . import command, faults

        faults.write(command.find(arguments.motehound), arguments.out, arguments.markdown, arguments.runs)
        print(arguments.markdown)
    elif arguments.command == "picture":
        from . import command, picture

        picture.write(command.find(arguments.motehound), arguments.out, arguments.image)
        print(arguments.image)
    elif arguments.command == "export":
        from . import export

        print(f"{arguments.out}: {export.write(arguments.log, arguments.to, arguments.out)}")
    elif arguments.command == "view":
        from . import recording
        from .view import server

        if not 0 <= arguments.port < 65536:
            raise Failure(f"--port {arguments.port}: expected 0 to 65535")
        found = recording.of_log(arguments.log) if arguments.log else recording.of_bus(arguments.bus)
        server.serve(found, live=arguments.log is None, port=arguments.port)
    elif arguments.command == "bound":
        from . import bound
        from .scenario import Scenario

        found = bound.over_deployments(Scenario.read(arguments.folder / "scenario.json"), arguments.seeds)
        print("prior of the acceleration, m/s2   rms, m   median, m")
        for prior, figures in found.items():
            print(f"{prior:>30}   {figures['rms_m']:6.3f}   {figures['median_m']:9.3f}")


def main() -> int:
    arguments = parser().parse_args()
    try:
        perform(arguments)
    except Failure as failure:
        print(f"motehound_tools: {failure}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        return 1
    except KeyboardInterrupt:
        print("motehound_tools: interrupted", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
