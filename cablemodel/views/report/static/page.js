"use strict";
(() => {
  const LINES = 0, MARKS = [1, 2, 3, 4], TRACK = 5, SEA = 6, FLOOR = 7;
  const ALL_IN = 15;                 // seconds in which a run plays by default
  const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
  const FLOOR_CELLS = 16;
  const KINDS = { f4: Float32Array, f8: Float64Array };

  const run = JSON.parse(document.getElementById("run").textContent);
  const element = (id) => document.getElementById(id);
  const narrow = () => window.innerWidth <= 600;

  /** An array as Python wrote it: its values, and its shape. */
  function decoded(spec) {
    const text = atob(spec.bdata), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    return { values: new KINDS[spec.dtype](bytes.buffer), shape: spec.shape.split(",").map(Number) };
  }

  const time = decoded(run.time).values, frames = time.length;
  const shape = run.shape;
  const position = decoded(shape.position), marks = shape.marks.map(decoded);
  const ground = decoded(shape.ground).values;
  const tension = decoded(shape.tension), arc = decoded(shape.s).values;
  const boxes = { follow: decoded(shape.boxes.follow).values, map: decoded(shape.boxes.map).values };
  const floor = shape.floor && { level: shape.floor.level, x: decoded(shape.floor.x).values,
    y: decoded(shape.floor.y).values, z: decoded(shape.floor.z).values };
  // Of the line that is shown: its heat maps, where its curves end, and its stations.
  let line = Object.keys(run.lines)[0], maps = {}, ends = {}, stations = [];

  let view = shape.follow ? "follow" : "map";
  let frame = -1, clock = 0, playing = false, last = 0, waiting = false;

  // ---- the shape ----

  /** Points (from, to) of a frame as x, y, z, in the present view. */
  function points(array, index) {
    const count = array.shape[1], x = new Float64Array(count), y = new Float64Array(count), z = new Float64Array(count);
    const [east, north] = view === "map" ? [ground[2 * index], ground[2 * index + 1]] : [0, 0];
    for (let i = 0, at = 3 * count * index; i < count; i++, at += 3) {
      x[i] = array.values[at] + east;
      y[i] = array.values[at + 1] + north;
      z[i] = array.values[at + 2];
    }
    return [x, y, z];
  }

  function drawShape(index) {
    const count = tension.shape[1];
    const force = tension.values.slice(index * count, (index + 1) * count);
    const data = Array.from(force, (value, i) => [arc[index * count + i], value]);
    const update = { x: [], y: [], z: [], "line.color": [force], customdata: [data] };
    const traces = [LINES, ...MARKS];
    for (const places of [position, ...marks]) {
      const [x, y, z] = points(places, index);
      update.x.push(x);
      update.y.push(y);
      update.z.push(z);
    }
    for (const _ of MARKS) {
      update["line.color"].push(undefined);
      update.customdata.push(undefined);
    }
    if (floor && !floor.level && view === "follow") {
      const surface = floorAround(index);
      traces.push(FLOOR);
      for (const key of ["x", "y", "z"]) update[key].push(surface[key]);
      update["line.color"].push(undefined);
      update.customdata.push(undefined);
    }
    return Plotly.restyle("shape", update, traces);
  }

  /** Height of the floor between the points of its grid; beyond them that of its edge. */
  function heightOfFloor(x, y) {
    const place = (values, at) => {
      const last = values.length - 1, step = (values[last] - values[0]) / last;
      const where = Math.min(Math.max((at - values[0]) / step, 0), last), cell = Math.min(Math.floor(where), last - 1);
      return [cell, where - cell];
    };
    const [i, u] = place(floor.x, x), [j, v] = place(floor.y, y), n = floor.x.length, z = floor.z;
    return (1 - v) * ((1 - u) * z[j * n + i] + u * z[j * n + i + 1])
      + v * ((1 - u) * z[(j + 1) * n + i] + u * z[(j + 1) * n + i + 1]);
  }

  function spaced(low, high, cells) {
    return Array.from({ length: cells + 1 }, (_, i) => low + ((high - low) * i) / cells);
  }

  /** The part of the floor that is in the box. */
  function floorAround(index) {
    const box = boxes[view], cells = floor.level ? 1 : FLOOR_CELLS;
    const [east, north] = view === "follow" ? [ground[2 * index], ground[2 * index + 1]] : [0, 0];
    const x = spaced(box[0], box[1], cells), y = spaced(box[2], box[3], cells);
    // Above or below the box there is nothing to show.
    const z = y.map((b) => x.map((a) => {
      const height = heightOfFloor(a + east, b + north);
      return height < box[4] || height > box[5] ? null : height;
    }));
    return { x, y, z };
  }

  /** Camera and box of the view, and the surfaces in it. */
  function setView(name) {
    view = name;
    const box = boxes[name], scene = fitted(shape.views[name]);
    const surfaces = { visible: [], x: [], y: [], z: [] };
    const flat = (level) => ({ x: [box[0], box[1]], y: [box[2], box[3]], z: [[level, level], [level, level]] });
    for (const [seen, surface] of [[shape.sea, flat(0)], [Boolean(floor), floor ? floorAround(Math.max(frame, 0)) : flat(0)]]) {
      surfaces.visible.push(seen);
      for (const key of ["x", "y", "z"]) surfaces[key].push(surface[key]);
    }
    element("origin").textContent = name === "follow" ? `x and y from ${shape.reference}, z from still water. ` : "";
    const layout = {};
    for (const [key, value] of Object.entries(scene)) layout["scene." + key] = value;
    for (const button of document.querySelectorAll("#view button"))
      button.setAttribute("aria-pressed", String(button.dataset.view === name));
    return Plotly.restyle("shape", { visible: name === "map" && shape.travels }, [TRACK])
      .then(() => Plotly.update("shape", surfaces, layout, [SEA, FLOOR]));
  }

  /** A scene with the camera moved along its line of sight, and aside, until the box fills the figure. */
  function fitted(scene) {
    const HALF_ANGLE = Math.PI / 8;    // plotly sees 45 degrees high
    // Pixels above and below, and on both sides, where the title of the vertical axis is outermost.
    const LABELS = narrow() ? 54 : 28, ASIDE = 54;
    const size = element("shape")._fullLayout._size, tangent = Math.tan(HALF_ANGLE);
    const high = tangent * (1 - (2 * LABELS) / size.h), wide = tangent * ((size.w - 2 * ASIDE) / size.h);
    const { x, y, z } = scene.camera.eye, length = Math.hypot(x, y, z), level = Math.hypot(x, y);
    const toward = [x / length, y / length, z / length];
    const right = [-y / level, x / level, 0];
    const up = [(-x * z) / (level * length), (-y * z) / (level * length), level / length];
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const half = ["x", "y", "z"].map((axis) => scene.aspectratio[axis] / 2), corners = [];
    for (const i of [-1, 1]) for (const j of [-1, 1]) for (const k of [-1, 1]) corners.push([i * half[0], j * half[1], k * half[2]]);
    let away = length, beside = 0, above = 0;
    for (let pass = 0; pass < 20; pass++) {
      const seen = corners.map((p) => { const far = away - dot(p, toward); return [(dot(p, right) - beside) / far, (dot(p, up) - above) / far]; });
      const limits = [0, 1].map((i) => [Math.min(...seen.map((p) => p[i])), Math.max(...seen.map((p) => p[i]))]);
      beside += (away * (limits[0][0] + limits[0][1])) / 2;
      above += (away * (limits[1][0] + limits[1][1])) / 2;
      away *= Math.max((limits[0][1] - limits[0][0]) / (2 * wide), (limits[1][1] - limits[1][0]) / (2 * high));
    }
    const axes = ["x", "y", "z"], center = {}, eye = {};
    axes.forEach((axis, i) => {
      center[axis] = beside * right[i] + above * up[i];
      eye[axis] = center[axis] + away * toward[i];
    });
    return { ...scene, camera: { ...scene.camera, eye, center } };
  }

  // ---- curves that move with time ----

  /** Take over a line's curves. */
  function chooseLine(name) {
    const { figures, notes, ends: given } = run.lines[name];
    line = name;
    maps = {};
    ends = {};
    for (const [profile, map] of Object.entries(run.profiles)) maps[profile] = decoded(figures[map].data[0].z);
    for (const [quantity, values] of Object.entries(given)) ends[quantity] = decoded(values).values;
    stations = decoded(figures["tension-map"].data[0].y).values;
    for (const [map, note] of Object.entries(notes)) element(`${map}-note`).textContent = note;
    for (const place of document.querySelectorAll(".line")) place.textContent = name || "the cable";
    for (const place of document.querySelectorAll(".of-line")) place.textContent = name && `, ${name}`;
  }

  /** Show another line, at the same time and zoom. */
  async function showLine(name) {
    chooseLine(name);
    for (const [figure, { data, layout }] of Object.entries(run.lines[name].figures)) {
      const { range } = element(figure)._fullLayout.xaxis;
      if (run.overTime.includes(figure)) layout.xaxis.range = range.slice();
      await Plotly.react(figure, data, layout);
    }
    return show(frame, true);
  }

  function drawProfiles(index) {
    return Promise.all(Object.entries(maps).map(([name, map]) => {
      const columns = map.shape[1], x = [], y = [];
      for (let i = 0; i < stations.length && stations[i] < ends.s[index]; i++) {
        const value = map.values[i * columns + index];
        if (Number.isNaN(value)) break;
        x.push(stations[i]);
        y.push(value);
      }
      x.push(ends.s[index]);
      y.push(ends[name][index]);
      return Plotly.restyle(name, { x: [x], y: [y] }, [2]);
    }));
  }

  function drawCursors() {
    for (const name of run.overTime) {
      const figure = element(name), full = figure._fullLayout;
      let cursor = figure.querySelector(".cursor");
      if (!cursor) {
        cursor = document.createElement("div");
        cursor.className = "cursor";
        figure.append(cursor);
      }
      const axis = full.xaxis, x = axis.d2p(clock / run.seconds);
      cursor.hidden = !(x >= -1 && x <= axis._length + 1);
      cursor.style.left = `${axis._offset + x}px`;
      cursor.style.top = `${full._size.t}px`;
      cursor.style.height = `${full._size.h}px`;
    }
  }

  // ---- time ----

  const digits = Math.max(0, Math.min(4, 2 - Math.floor(Math.log10((time[frames - 1] - time[0] || 1) / run.seconds / 10))));
  const shown = (seconds) => (seconds / run.seconds).toFixed(digits);

  function nearest(seconds) {
    let low = 0, high = frames - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (time[middle] <= seconds) low = middle; else high = middle;
    }
    return seconds - time[low] <= time[high] - seconds ? low : high;
  }

  function show(index, force = false) {
    clock = time[index];
    if (index === frame && !force) return Promise.resolve();
    frame = index;
    element("time").value = String(index);
    element("time").setAttribute("aria-valuetext", `${shown(clock)} ${run.hours}`);
    element("clock").value = `${shown(clock)} / ${shown(time[frames - 1])} ${run.hours}`;
    for (const moment of document.querySelectorAll(".moment")) moment.textContent = `at ${shown(clock)} ${run.hours}`;
    drawCursors();
    document.body.dataset.frame = String(index);
    return Promise.all([drawShape(index), drawProfiles(index)]);
  }

  function play(on) {
    playing = on && frames > 1;
    const button = element("play");
    button.textContent = playing ? "\u275A\u275A" : "\u25B6\uFE0E";
    button.setAttribute("aria-label", playing ? "Pause" : "Play");
    if (!playing) return;
    if (frame >= frames - 1) show(0);
    last = 0;
    requestAnimationFrame(tick);
  }

  let reached = 0;
  function tick(now) {
    if (!playing) return;
    if (last === 0) reached = clock;
    else reached += ((now - last) / 1000) * Number(element("speed").value);
    last = now;
    const end = time[frames - 1];
    if (!waiting) {
      // A frame that takes long to draw is followed by a later one: the clock keeps its speed.
      waiting = true;
      show(nearest(Math.min(reached, end))).then(() => { waiting = false; });
    }
    if (reached >= end) { play(false); show(frames - 1); } else requestAnimationFrame(tick);
  }

  // ---- zoom and clicks ----

  let following = false;
  function linkZoom(name, change) {
    drawCursors();
    if (following) return;
    let update = null;
    if ("xaxis.range[0]" in change) update = { "xaxis.range": [change["xaxis.range[0]"], change["xaxis.range[1]"]], "xaxis.autorange": false };
    else if ("xaxis.range" in change) update = { "xaxis.range": change["xaxis.range"].slice(), "xaxis.autorange": false };
    else if (change["xaxis.autorange"]) update = { "xaxis.autorange": true };
    if (!update) return;
    following = true;
    Promise.all(run.overTime.filter((other) => other !== name).map((other) => Plotly.relayout(other, { ...update })))
      .finally(() => { following = false; drawCursors(); });
  }

  function goTo(event) {
    if (!event.points.length) return;
    play(false);
    show(nearest(event.points[0].x * run.seconds));
  }

  // ---- start ----

  async function start() {
    const config = (name) => ({ responsive: true, displaylogo: false, displayModeBar: narrow() ? false : "hover",
      modeBarButtons: [["toImage", name === "shape" ? "resetCameraDefault3d" : "resetScale2d"]] });
    const touch = window.matchMedia("(pointer: coarse)").matches;
    for (const figures of [run.figures, ...Object.values(run.lines).map((one) => one.figures)])
      for (const [name, { layout }] of Object.entries(figures)) {
        if (touch && name !== "shape") layout.dragmode = false;    // a finger on a chart scrolls the page
        if (narrow() && layout.margin.l) layout.margin = { ...layout.margin, l: 50, r: 8 };
        if (narrow() && name === "shape") {
          for (const scene of [layout.scene, ...Object.values(shape.views)])
            for (const axis of ["xaxis", "yaxis", "zaxis"]) scene[axis] = { ...scene[axis],
              nticks: Math.max(2, Math.ceil(scene[axis].nticks / 2)), tickfont: { size: 9 } };
        }
      }
    chooseLine(line);
    for (const [name, figure] of Object.entries({ ...run.figures, ...run.lines[line].figures }))
      await Plotly.newPlot(name, figure.data, figure.layout, config(name));
    for (const name of run.overTime) {
      element(name).on("plotly_relayout", (change) => linkZoom(name, change));
      element(name).on("plotly_afterplot", drawCursors);
      element(name).on("plotly_click", goTo);
    }
    const slider = element("time");
    slider.max = String(frames - 1);
    slider.addEventListener("input", () => { play(false); show(Number(slider.value)); });
    element("play").addEventListener("click", () => play(!playing));
    document.addEventListener("keydown", (event) => {
      if (event.key === " " && event.target === document.body) { event.preventDefault(); play(!playing); }
    });
    const rate = (time[frames - 1] - time[0]) / ALL_IN;
    const speed = SPEEDS.reduce((best, one) => (Math.abs(Math.log(one / rate)) < Math.abs(Math.log(best / rate)) ? one : best));
    for (const one of SPEEDS) if (one === 1 || (one >= speed / 20 && one <= speed * 10)) {
      element("speed").add(new Option(`${one} ×`, String(one), one === speed, one === speed));
    }
    for (const button of document.querySelectorAll("#view button")) button.addEventListener("click", () => {
      setView(button.dataset.view).then(() => show(frame, true));
    });
    element("line").addEventListener("change", (event) => showLine(event.target.value));
    element("view").hidden = !shape.travels;
    if (line) document.querySelector("[data-view=follow]").textContent = `follow ${shape.reference}`;
    await setView(view);
    await show(0, true);
    document.body.dataset.ready = "true";
  }

  start();
})();
