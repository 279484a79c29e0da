"""The page: all in one file but the latencies, and nothing of it from a network."""

import base64
import gzip
import html
import json
import pathlib

import numpy

from . import record, solids
from .files import Missing
from .looks import COLORS, LEVEL_COLORS, NAMES

HERE = pathlib.Path(__file__).resolve().parent
PICTURES_MAX = 3_600_000  # [bytes] that the page holds; what is beyond lies beside it
SCENES_MAX = 2_000_000  # [bytes], compressed, of what can be turned
TABLE = ("stop", "when", "for", "why", "link", "what was found", "what helps")


def plotly():
    """Its graph objects and the text of plotly.js."""
    try:
        import plotly.graph_objects  # pylint: disable=import-outside-toplevel
        import plotly.offline  # pylint: disable=import-outside-toplevel
        return plotly.graph_objects, plotly.offline.get_plotlyjs()
    except ImportError as error:
        raise Missing("report.html needs the Debian package python3-plotly; the pictures are "
                      f"drawn ({error})") from error


def packed(text):
    """Compressed, for a page; the same bytes in each run."""
    return base64.b64encode(gzip.compress(text.encode("utf-8"), 9, mtime=0)).decode("ascii")


def as_json(value):
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)


def escaped(text):
    return html.escape(str(text), quote=True)


def timeline(found, objects):
    """Reasons by level over what was measured; what stands at a point is told where one points."""
    reasons = [one for one in record.WORDS if any(row["reason"] == one for row in found.rows)]
    some = record.bounded(record.segments(found.rows))
    figure = objects.Figure()
    for level, color in LEVEL_COLORS.items():
        of_level = [one for one in some if one[2] == level]
        if not of_level:
            continue
        texts = [f"{level} {reason}" + (f" of {escaped(link)}" if link else "") +
                 f"<br>{begin:.2f} s to {end:.2f} s: {escaped(record.words(reason))}"
                 for begin, end, _level, reason, link in of_level]
        figure.add_bar(base=[one[0] for one in of_level], y=[one[3] for one in of_level],
                       x=[max(one[1] - one[0], 0.01) for one in of_level], orientation="h",
                       marker={"color": color, "line": {"width": 0}}, name=level, yaxis="y",
                       hovertext=texts, hoverinfo="text")
    from .pictures import ROWS  # pylint: disable=import-outside-toplevel
    for axis, (column, label, scale, worst, color) in zip(("y2", "y3", "y4"), ROWS):
        times, values = record.series(found.rows, column, worst)
        figure.add_scatter(x=times, y=[None if v is None else round(scale * v, 3) for v in values],
                           name=label, yaxis=axis, mode="lines", line={"color": color, "width": 1.5},
                           showlegend=False, hovertemplate="%{y:.3g} at %{x:.2f} s<extra></extra>")
    low = 0.66 - min(0.16, 0.012 * len(reasons))
    parts = [(low + 0.03, 1.0)] + [(low * k / 3 + 0.02, low * (k + 1) / 3 - 0.02) for k in (2, 1, 0)]
    figure.update_layout(
        barmode="overlay", bargap=0.15, height=520 + 18 * len(reasons), showlegend=True,
        margin={"l": 150, "r": 20, "t": 60, "b": 45}, paper_bgcolor="white", plot_bgcolor="white",
        legend={"orientation": "h", "x": 1, "xanchor": "right", "y": 1.03, "yanchor": "bottom"},
        xaxis={"title": "time since the recording's first message [s]", "anchor": "y4",
               "gridcolor": "#eee", "zeroline": False},
        yaxis={"domain": parts[0], "categoryorder": "array", "categoryarray": reasons,
               "fixedrange": True},
        **{f"yaxis{k}": {"domain": parts[k - 1], "title": row[1].replace(" [", "<br>["),
                         "rangemode": "tozero", "gridcolor": "#eee", "fixedrange": True,
                         **({"range": [0, 105]} if row[0] == "visible" else {})}
           for k, row in zip((2, 3, 4), ROWS)},
        shapes=[{"type": "rect", "xref": "x", "yref": "paper", "x0": stop["from_s"],
                 "x1": stop["to_s"], "y0": 0, "y1": 1, "layer": "below", "line": {"width": 0},
                 "fillcolor": "rgba(228,71,59,0.07)"} for stop in found.stops],
        annotations=[{"x": stop["from_s"], "y": 1.0, "xref": "x", "yref": "paper",
                      "xanchor": "left", "yanchor": "bottom", "showarrow": False,
                      "text": f"stop {number}"} for number, stop in enumerate(found.stops[:20], 1)])
    return json.loads(figure.to_json())


class Shapes:
    """Meshes of primitives, each kind and size once."""

    def __init__(self):
        self.known, self.meshes = {}, []

    def of(self, shape):
        """[mesh, position, rotation]"""
        key = as_json([shape["kind"], shape["size"]])
        if key not in self.known:
            vertices, triangles = solids.mesh(shape["kind"], shape["size"])
            self.known[key] = len(self.meshes)
            self.meshes.append({"v": numpy.round(vertices, 4).ravel().tolist(),
                                "t": triangles.ravel().tolist()})
        turn = [round(value, 4) for value in shape["rotation"]]
        return [self.known[key], shape["position"], turn]


def turnable(scene, shapes):
    """Of a stop: layers of boxes and of primitives, and how it is looked at first."""
    layers = []
    for kind in ("robot", "concerned", "ahead"):
        some = [shapes.of(shape) for shape in scene.robot(kind)]
        opacity = {"robot": 0.35, "concerned": 0.4, "ahead": 0.25}[kind]
        layers.append({"kind": kind, "shapes": some, "opacity": opacity})
    for region in scene.json.get("regions", []):
        layers.append({"kind": "region", "shapes": [shapes.of(region)],
                       "opacity": 0.4 if region["touched"] else 0.15})
    for kind, some in (("map", scene.cuboids), ("held", scene.held), *scene.flagged.items()):
        layers.append({"kind": kind, "boxes": some, "opacity": 0.5 if kind == "held" else 1.0,
                       "flagged": kind in scene.flagged})
    json_of = {"layers": [one for one in layers if one.get("boxes") or one.get("shapes")],
               "sensors": scene.sensors, "unseen": scene.unseen.tolist(),
               "view": solids.direction(*scene.view).round(4).tolist(), "names": dict(scene.legend())}
    if scene.point is not None:
        json_of.update(point=scene.point.tolist(), what=escaped(scene.what_text()))
    return json_of


def turnable_map(found, shapes):
    """As it was at the end."""
    layers = [{"kind": "robot", "opacity": 0.5, "shapes": [
        shapes.of(shape) for shape in found.scenes.get("robot_at_the_end", [])]}]
    some = [box for one in found.scenes["maps"] for box in one["cuboids"] + one["held"]]
    layers.append({"kind": "map", "boxes": some, "opacity": 1.0, "by_height": True})
    sensors = [{"name": one["sensor"], "position": one["position"], "saw": False}
               for one in found.scenes["maps"]]
    return {"layers": [one for one in layers if one.get("boxes") or one.get("shapes")],
            "sensors": sensors, "unseen": [], "view": solids.direction(*solids.MAP_VIEW).round(4).tolist(),
            "names": {"map": NAMES["map"] + ", by height", "robot": "robot at the end"}}


def scenes_of(found):
    """By the picture's name; as many as fit."""
    shapes, scenes, size = Shapes(), {}, 0
    for name, make in [("map_in_3d", lambda: turnable_map(found, shapes))] + [
            (name, lambda scene=scene: turnable(scene, shapes))
            for _number, name, _stop, scene in found.drawn_scenes()
            if scene.json.get("cuboids")]:
        scene = make()
        size += len(gzip.compress(as_json(scene).encode("utf-8"), 6, mtime=0))
        if size > SCENES_MAX:
            break
        scenes[name] = scene
    return {"scenes": scenes, "shapes": shapes.meshes, "colors": COLORS}


class Pictures:
    """Held by the page as long as there is room."""

    def __init__(self, drawn):
        self.drawn, self.left = drawn, PICTURES_MAX

    def image(self, name, text):
        source = name + ".png"
        content = base64.b64encode(self.drawn[source]).decode("ascii") if name != "latency" else ""
        if content and len(content) <= self.left:
            self.left -= len(content)
            source = "data:image/png;base64," + content
        return f'<img src="{source}" alt="{escaped(text)}">'

    def figure(self, name, text, caption="", can_turn=False):
        button = (f'<button type="button" data-scene="{name}" hidden>Turn it in 3D</button>'
                  if can_turn else "")
        return (f'<figure id="{name}"><div class="picture">{self.image(name, text)}{button}</div>'
                f"<figcaption>{escaped(caption)}</figcaption></figure>")


def summary_text(found):
    """What a tired operator wants to know."""
    summary, stops = found.summary, found.stops
    length = summary["duration_s"]
    text = (f"{summary['scans']} of {summary['scans_received']} scans were mapped in "
            f"{record.duration(length or 0.0)} of the recording. ")
    if not summary["checks"]:
        return text + "There was no robot to check."
    if not stops:
        return text + f"The robot was checked {summary['checks']} times, and was never stopped."
    total = sum(stop["length_s"] for stop in stops)
    longest = max(range(len(stops)), key=lambda i: stops[i]["length_s"])
    gravest = max(stops, key=lambda stop: list(record.WORDS).index(stop["reason"])
                  if stop["reason"] in record.WORDS else -1)
    count = found.scenes["stops_in_all"]
    text += (f"The robot was checked {summary['checks']} times and was stopped "
             f"{'once' if count == 1 else f'{count} times'}, for {record.duration(total)} in all")
    text += (f"; the longest stop was number {longest + 1}, {record.duration(stops[longest]['length_s'])}. "
             if count > 1 else ". ")
    text += f"The gravest reason was {gravest['reason']}: {record.words(gravest['reason'])}"
    return text + (f" ({gravest['detail']})." if gravest["detail"] else ".")


def helps_of(stop):
    return stop["what_helps"].replace(" (how)", "") or "see docs/failures.md"


def table(found):
    rows = []
    for number, stop in enumerate(found.stops, 1):
        why = f"<b>{escaped(stop['reason'])}</b><br>{escaped(record.words(stop['reason']))}"
        cells = [f'<a href="#stop-{number}">{number}</a>', f"{stop['from_s']:.2f} s",
                 record.duration(stop["length_s"]), why, escaped(stop["link"]),
                 escaped(stop["detail"]), escaped(helps_of(stop))]
        rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    head = "".join(f"<th>{cell}</th>" for cell in TABLE)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def stop_parts(found, pictures, turnables):
    parts, last = [], None
    for number, name, stop, scene in found.drawn_scenes():
        if number != last:
            parts.append(f'<h3 id="stop-{number}">Stop {number}, at {stop["from_s"]:.2f} s for '
                         f'{record.duration(stop["length_s"])}: {escaped(stop["reason"])}</h3>')
            helps = helps_of(stop)
            parts.append(f"<p><b>{escaped(stop['detail'] or record.words(stop['reason']))}.</b> "
                         f"What helps: {escaped(helps)}."
                         + (f" Reasons in turn: {escaped(stop['in_turn'])}." if stop["in_turn"] else "")
                         + "</p>")
        last = number
        what = scene.json["detail"] or record.words(scene.json["reason"])
        caption = f"At {scene.json['at_s']:.2f} s: {scene.short_text()}: {what}. {scene.text()}"
        caption = caption.rstrip(" .") + "."
        parts.append(pictures.figure(name, caption, caption, name in turnables))
    if found.scenes["stops_in_all"] > len(found.stops):
        parts.append(f"<p>{found.scenes['stops_in_all'] - len(found.stops)} more stops have no "
                     "picture; stop_segments in summary.json has all.</p>")
    return "\n".join(parts)


def latency(pictures):
    return "<h2>How long checks took</h2>\n" + pictures.figure(
        "latency", "latency.png, beside this page: how long checks took after a scan", "From a scan to the verdict on "
        "this computer; it differs from run to run, so it lies beside this page.")


def of(found, drawn):
    """@param drawn the pictures, by their names. @raises Missing"""
    objects, code = plotly()
    data = scenes_of(found)
    data["timeline"] = timeline(found, objects)
    pictures = Pictures(drawn)
    interrupted = ('<p class="warning">Interrupted: only what was played until then is here.</p>'
                   if found.scenes["interrupted"] else "")
    no_scenes = "" if found.stops else "<p>There was none.</p>"
    values = {
        "TITLE": escaped(f"What stopped {found.robot}" if found.scenes["robot"] else "The map"),
        "STYLE": (HERE / "page.css").read_text(encoding="utf-8"),
        "INTERRUPTED": interrupted, "SUMMARY": escaped(summary_text(found)),
        "TIMELINE": pictures.figure("timeline", "level, reasons, clearance, visible share and the "
                                    "map's age over time"),
        "TABLE": table(found) if found.stops else no_scenes,
        "STOPS": stop_parts(found, pictures, data["scenes"]),
        "MAP": (pictures.figure("map_from_above", "the map after the last scan, from above",
                                "From above, by height, after the last scan; the robot as it was "
                                "then. Circles: what stops were about.")
                + pictures.figure("map_in_3d", "the same map in 3D", "The same in 3D.",
                                  "map_in_3d" in data["scenes"])),
        "LATENCY": latency(pictures) if found.timing is not None else "",
        "PLOTLY": packed(code), "DATA": packed(as_json(data)),
        "SCRIPT": (HERE / "page.js").read_text(encoding="utf-8")}
    parts = (HERE / "page.html").read_text(encoding="utf-8").split("@@")
    return "".join(values[part] if i % 2 else part for i, part in enumerate(parts)).encode("utf-8")
