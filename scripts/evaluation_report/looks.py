"""How a stop's scene is looked at and coloured: the same in pictures and in what can be turned."""

import numpy

from . import solids

LEVEL_COLORS = {"OK": "#4daf4a", "SLOW": "#f2c233", "STOP": "#e4473b", "FAULT": "#6b2d73"}
COLORS = {"touched": "#e3001b", "hides": "#7a1fd1", "concerned": "#ff9f1c", "robot": "#7f96b2",
          "ahead": "#5bc0be", "map": "#b8b8b8", "held": "#cdbfe0", "region": "#e8743b",
          "unseen": "#ff8c00", "sensor": "#00695c"}
NAMES = {"concerned": "link concerned", "robot": "rest of the robot", "ahead": "where it was going",
         "map": "what the sensor saw", "held": "seen before, out of sight now",
         "region": "region to keep out of"}


class Scene:
    """@var point what all is about, or None. @var view azimuth and elevation in degrees."""

    def __init__(self, scene):
        self.json = scene
        self.sensors = scene.get("sensors", [])
        self.point = numpy.array(scene["point"]) if "point" in scene else None
        self.unseen = numpy.array(scene.get("unseen", []), dtype=float).reshape(-1, 3)
        self.flagged = {kind: [one["box"] for one in scene.get("flagged", [])
                               if one["why"] in whys]
                        for kind, whys in (("touched", ("touched", "was_touched")),
                                           ("hides", ("hides", "was_hiding")))}
        known = {tuple(box) for some in self.flagged.values() for box in some}
        self.cuboids = [box for box in scene.get("cuboids", []) if tuple(box) not in known]
        self.held = [box for box in scene.get("held", []) if tuple(box) not in known]
        self.known_view = None

    @property
    def view(self):
        if self.known_view is None:
            self.known_view = self.best_view()
        return self.known_view

    def robot(self, kind):
        """Primitives: of the robot as it was, or where it was going."""
        concerned = set(self.json.get("concerned", []))
        if kind == "ahead":
            return self.json.get("robot_ahead", [])
        return [shape for shape in self.json.get("robot", [])
                if (shape["link"] in concerned) == (kind == "concerned")]

    def best_view(self):
        some = [box for boxes in self.flagged.values() for box in boxes]
        middles = [0.5 * (numpy.array(box[:3]) + numpy.array(box[3:])) for box in some[:12]]
        if self.point is not None:
            middles.append(self.point)
        if not middles:
            return (-140, 38)
        line = None
        saw = [sensor for sensor in self.sensors if sensor["saw"]]
        if saw and self.point is not None:
            line = self.point - numpy.array(saw[0]["position"])
            line = line / max(1e-9, numpy.linalg.norm(line))
        return solids.best_view(middles, self.cuboids, self.robot("robot") + self.robot("concerned"), line)

    def layers(self):
        """Yields what a layer is of, its triangles and opacity."""
        yield "map", solids.boxes(self.cuboids), 1.0
        yield "held", solids.boxes(self.held), 0.5
        for kind, opacity in (("ahead", 0.3), ("robot", 0.6), ("concerned", 0.85)):
            some = [solids.placed(shape) for shape in self.robot(kind)]
            if some:
                yield kind, numpy.concatenate(some), opacity
        for region in self.json.get("regions", []):
            yield "region", solids.placed(region), 0.45 if region["touched"] else 0.15
        for kind, some in self.flagged.items():
            yield kind, solids.boxes(some, 0.001), 1.0

    def extent(self, towards):
        """On the screen, of the robot, what it is about, and the sensors that saw it."""
        points = [numpy.array(sensor["position"])[None] for sensor in self.sensors]
        points += [solids.placed(shape).reshape(-1, 3) for shape in self.json.get("robot", [])]
        if self.point is not None:
            points.append(self.point[None])
        if not points or "robot" not in self.json:
            points.append(solids.boxes(self.cuboids).reshape(-1, 3))
        seen = numpy.concatenate(points) @ towards[:2].T
        margin = 0.05 + 0.05 * (seen.max(axis=0) - seen.min(axis=0))
        return seen.min(axis=0) - margin, seen.max(axis=0) + margin

    def cause(self):
        """What brought the stop about, where that is over: (reason, detail), or None."""
        cause = self.json.get("cause")
        return (cause["reason"], cause["detail"]) if cause else None

    def short_text(self):
        link = f" of {self.json['link']}" if self.json["link"] else ""
        return f"{self.json['reason']}{link}"

    def what_text(self):
        """At the arrow's end."""
        link, reason = self.json["link"], self.json["reason"]
        if self.cause():
            return f"this is what it was about: {self.cause()[0]}"
        if reason == "COLLISION":
            return f"{link} touches this"
        if reason == "COLLISION_AHEAD":
            first = self.json.get("first_contact")
            when = f" in {1e3 * first['time_s']:.0f} ms" if first else ""
            near = " comes too near to this" if first and first["by_margin"] else " would touch this"
            return f"{link}{near}{when}"
        if reason == "APPROACHED":
            return f"this came near {link}"
        if reason in ("OCCLUSION", "OCCLUSION_AHEAD"):
            return f"{link} is hidden"
        return link or reason

    def legend(self):
        """Yields a layer's kind and what it is."""
        was = self.cause() is not None
        if self.flagged["touched"]:
            ahead = self.json["reason"].endswith("_AHEAD")
            yield "touched", ("what was touched before" if was else
                              "what would be touched" if ahead else "what is touched")
        if self.flagged["hides"]:
            yield "hides", "what hid it before" if was else "what hides it"
        for kind, some in (("concerned", self.robot("concerned")), ("robot", self.robot("robot")),
                           ("ahead", self.robot("ahead")), ("map", self.cuboids),
                           ("held", self.held), ("region", self.json.get("regions"))):
            if some:
                yield kind, NAMES[kind]

    def text(self):
        """For below the picture."""
        parts = []
        ahead = self.json["reason"].endswith("_AHEAD")
        concerned = self.json.get("concerned", [])
        links, several = ", ".join(concerned) or "the robot", len(concerned) > 1
        touch, are = "touch" if several else "touches", "are" if several else "is"
        for kind, verb in (("touched", "would touch" if ahead else touch),
                           ("hides", are + " hidden behind")):
            count = len(self.flagged[kind])
            if count and not self.cause():
                parts.append(f"{links} {verb} {count} {'box' if count == 1 else 'boxes'} of the map")
        if self.cause():
            reason, detail = self.cause()
            parts.append(f"what came before: {reason}: {detail}")
        for sensor in self.sensors:
            if sensor["saw"] and self.point is not None:
                away = numpy.linalg.norm(self.point - numpy.array(sensor["position"]))
                parts.append(f"{sensor['name'] or 'the sensor'} saw it from {away:.2f} m away")
        if not self.cuboids and not any(self.flagged.values()):
            parts.append("nothing of the surroundings was in the map yet")
        if "robot" not in self.json:
            parts.append("the robot could not be placed yet, and is not drawn")
        text = "; ".join(parts)
        return text[:1].upper() + text[1:] if text.startswith(("the ", "nothing ", "what ")) else text
