"use strict";
const OPEN_MAX = 6;  // browsers bear some sixteen canvases with WebGL
const CONFIG = {displaylogo: false, responsive: true, scrollZoom: true,
                modeBarButtonsToRemove: ["toImage", "sendDataToCloud", "select2d", "lasso2d"]};
const open = [];
let data = null;

function tell(text) {
  const note = document.getElementById("note");
  note.textContent = text;
  note.hidden = false;
}

async function unpacked(id) {
  const text = atob(document.getElementById(id).textContent);
  const bytes = Uint8Array.from(text, letter => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

function hasWebGL() {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("webgl") || canvas.getContext("experimental-webgl");
  if (!context) return false;
  const lose = context.getExtension("WEBGL_lose_context");
  if (lose) lose.loseContext();
  return true;
}

// Triangles of upright boxes and of placed shapes, as plotly's mesh3d has them.
const FACES = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
               2, 6, 7, 2, 7, 3, 1, 3, 7, 1, 7, 5, 0, 4, 6, 0, 6, 2];

function meshOf(layer) {
  const mesh = {x: [], y: [], z: [], i: [], j: [], k: [], heights: []};
  const addTriangles = (triangles, first) => {
    for (let n = 0; n < triangles.length; n += 3) {
      mesh.i.push(first + triangles[n]);
      mesh.j.push(first + triangles[n + 1]);
      mesh.k.push(first + triangles[n + 2]);
    }
  };
  const over = layer.flagged ? 0.001 : 0;
  for (const box of layer.boxes || []) {
    const first = mesh.x.length;
    for (let corner = 0; corner < 8; ++corner) {
      mesh.x.push(corner & 1 ? box[3] + over : box[0] - over);
      mesh.y.push(corner & 2 ? box[4] + over : box[1] - over);
      mesh.z.push(corner & 4 ? box[5] + over : box[2] - over);
      mesh.heights.push(box[5]);
    }
    addTriangles(FACES, first);
  }
  for (const [shape, p, r] of layer.shapes || []) {
    const {v, t} = data.shapes[shape];
    const first = mesh.x.length;
    for (let n = 0; n < v.length; n += 3) {
      mesh.x.push(p[0] + r[0] * v[n] + r[1] * v[n + 1] + r[2] * v[n + 2]);
      mesh.y.push(p[1] + r[3] * v[n] + r[4] * v[n + 1] + r[5] * v[n + 2]);
      mesh.z.push(p[2] + r[6] * v[n] + r[7] * v[n + 1] + r[8] * v[n + 2]);
    }
    addTriangles(t, first);
  }
  return mesh;
}

function traceOf(layer, scene) {
  const {heights, ...mesh} = meshOf(layer);
  const trace = {type: "mesh3d", ...mesh, opacity: layer.opacity, flatshading: true,
                 hoverinfo: "skip", name: scene.names[layer.kind] || layer.kind, showlegend: true,
                 lighting: layer.flagged ? {ambient: 1, diffuse: 0, specular: 0, fresnel: 0}
                                         : {ambient: 0.75, diffuse: 0.5, specular: 0, fresnel: 0}};
  if (layer.by_height) {
    Object.assign(trace, {intensity: heights, colorscale: "Viridis", showscale: false});
  } else {
    trace.color = data.colors[layer.kind];
  }
  return trace;
}

function sensorTraces(scene) {
  const traces = [];
  for (const sensor of scene.sensors) {
    const ends = sensor.saw && scene.point ? [sensor.position, scene.point] : [sensor.position];
    traces.push({type: "scatter3d", mode: "lines+markers+text", hoverinfo: "skip", showlegend: false,
                 x: ends.map(p => p[0]), y: ends.map(p => p[1]), z: ends.map(p => p[2]),
                 text: [escaped(sensor.name || "sensor")], textposition: "top center",
                 marker: {size: [6, 0], symbol: "diamond", color: data.colors.sensor},
                 line: {color: data.colors.sensor, width: 4, dash: "dash"}});
  }
  if (scene.unseen.length) {
    traces.push({type: "scatter3d", mode: "markers", hoverinfo: "skip", name: "not seen",
                 x: scene.unseen.map(p => p[0]), y: scene.unseen.map(p => p[1]),
                 z: scene.unseen.map(p => p[2]), marker: {size: 3, color: data.colors.unseen}});
  }
  return traces;
}

function escaped(text) {
  return text.replace(/[&<>]/g, letter => ({"&": "&amp;", "<": "&lt;", ">": "&gt;"}[letter]));
}

// A cube around all of it, so that no side is stretched, looked at around what it is about.
function layoutOf(scene, traces, height) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const trace of traces) {
    ["x", "y", "z"].forEach((axis, n) => {
      for (const value of trace[axis]) {
        low[n] = Math.min(low[n], value);
        high[n] = Math.max(high[n], value);
      }
    });
  }
  const half = 0.52 * Math.max(...high.map((value, n) => value - low[n]));
  const middle = high.map((value, n) => 0.5 * (value + low[n]));
  const about = scene.point || middle;
  const center = about.map((value, n) => (value - middle[n]) / (2 * half));
  const away = scene.point ? 0.85 : 1.25;
  const eye = center.map((value, n) => value + away * scene.view[n]);
  const axisOf = n => ({range: [middle[n] - half, middle[n] + half], title: ["x [m]", "y [m]", "z [m]"][n],
                        backgroundcolor: "#fafafa", showbackground: true, gridcolor: "#ddd"});
  const at = values => ({x: values[0], y: values[1], z: values[2]});
  const annotations = scene.point ? [{...at(scene.point), text: scene.what, ax: 90, ay: -70,
                                      bgcolor: "rgba(255,255,255,0.9)", bordercolor: "#555",
                                      arrowcolor: "#222", font: {size: 13}}] : [];
  return {height, margin: {l: 0, r: 0, t: 0, b: 0}, legend: {x: 0, y: 1},
          scene: {xaxis: axisOf(0), yaxis: axisOf(1), zaxis: axisOf(2), annotations,
                  aspectmode: "manual", aspectratio: {x: 1, y: 1, z: 1}, dragmode: "orbit",
                  camera: {center: at(center), eye: at(eye), up: {x: 0, y: 0, z: 1}}}};
}

function close(name) {
  const picture = document.getElementById(name).querySelector(".picture");
  const plot = picture.querySelector(".plot");
  if (!plot) return;
  Plotly.purge(plot);
  plot.remove();
  picture.classList.remove("turned");
  picture.querySelector("img").style.display = "";
  picture.querySelector("button").textContent = "Turn it in 3D";
  open.splice(open.indexOf(name), 1);
}

async function turn(name) {
  if (open.includes(name)) return close(name);
  if (open.length >= OPEN_MAX) close(open[0]);
  const picture = document.getElementById(name).querySelector(".picture");
  const image = picture.querySelector("img");
  const height = Math.max(420, image.clientHeight);
  const plot = document.createElement("div");
  plot.className = "plot";
  plot.id = "plot-" + name;
  image.style.display = "none";
  picture.append(plot);
  picture.classList.add("turned");
  open.push(name);
  picture.querySelector("button").textContent = "Back to the picture";
  const scene = data.scenes[name];
  const traces = scene.layers.map(layer => traceOf(layer, scene)).concat(sensorTraces(scene));
  await Plotly.newPlot(plot, traces, layoutOf(scene, traces, height), CONFIG);
  plot.dataset.drawn = "true";
}

async function begin() {
  if (!("DecompressionStream" in window)) {
    tell("This browser is too old to unpack what can be turned and zoomed: the pictures stand still.");
    return;
  }
  const code = document.createElement("script");
  code.textContent = await unpacked("plotly-code");
  document.head.append(code);
  data = JSON.parse(await unpacked("data"));
  const picture = document.getElementById("timeline").querySelector(".picture");
  const plot = document.createElement("div");
  plot.className = "plot";
  plot.id = "plot-timeline";
  picture.append(plot);
  await Plotly.newPlot(plot, data.timeline.data, data.timeline.layout, {...CONFIG, scrollZoom: false});
  picture.querySelector("img").style.display = "none";
  if (!hasWebGL()) {
    tell("This browser has no WebGL: the views in 3D stand still.");
  } else {
    for (const button of document.querySelectorAll("button[data-scene]")) {
      button.hidden = false;
      button.addEventListener("click", () => turn(button.dataset.scene));
    }
  }
  document.body.dataset.ready = "true";
}

begin().catch(error => tell("The pictures stand still, as this went wrong: " + error.message));
