// Keeps the labels at their points and the view parallel, tells what the mouse is over, keeps the
// pose that was picked, and obeys the keys. It lets a page with this scene in it scroll until the
// scene is asked for: without the shield it would swallow every wheel and swipe.
(function () {
  const POSE = ["position", "focalPoint", "viewUp"];
  const SHAPE = 1.6; // width over height of the picture that the view was fitted to
  const NEAR_PX = 16; // how near the mouse must be to a pose that is on no surface
  const TURN = Math.PI / 36;
  const INK = 0.2; // what is darker than this is drawn bright on dark ground
  const part = (id) => document.getElementById(id);
  const labels = Array.from(document.querySelectorAll("[data-at]"));
  const shield = part("shield"), button = part("home");
  const mark = part("mark"), near_ = part("near"), pointed = part("pointed"), picked = part("picked");
  const { title, unit, reasons, grids } = JSON.parse(part("poses").textContent);
  const points = grids.flatMap((grid) => grid.points);
  const triangles = grids.flatMap(trianglesOf);
  const ranked = points.map((_, k) => k).sort((a, b) => asked(points[b]) - asked(points[a]));
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const inks = new Set(); // of what is drawn in ink
  let home = null;
  let atHome = null; // when the camera was put home last
  let seen = "";
  let chosen = -1; // number of the pose that is picked
  let press = null;

  function stage() {
    const window_ = window.global && window.global.renderWindow;
    const renderers = window_ ? window_.getRenderers() : [];
    const renderer = renderers.find((one) => one.getActors().length > 0);
    return renderer ? { window_, renderer } : null; // the viewer's own renderer stays empty
  }

  // The view: where one looks from, and how vectors are counted

  const add = (a, b, times = 1) => a.map((x, k) => x + times * b[k]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [0, 1, 2].map((k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
  const unit_ = (a) => a.map((x) => x / Math.hypot(...a));

  function view({ renderer }) {
    const camera = renderer.getActiveCamera();
    const [position, focus, viewUp] = POSE.map((name) => [...camera.getReferenceByName(name)]);
    const away = unit_(add(focus, position, -1));
    const right = unit_(cross(away, viewUp));
    return { camera, position, focus, away, right, up: cross(right, away), scale: camera.getParallelScale() };
  }

  // Pixels from the left and the top, and how far away
  function pixel(seenFrom, point) {
    const from = add(point, seenFrom.focus, -1);
    const perMetre = window.innerHeight / (2 * seenFrom.scale);
    return [
      window.innerWidth / 2 + perMetre * dot(from, seenFrom.right),
      window.innerHeight / 2 - perMetre * dot(from, seenFrom.up),
      dot(from, seenFrom.away),
    ];
  }

  function draw({ window_, renderer }) {
    renderer.resetCameraClippingRange();
    window_.render();
  }

  function goHome(found) {
    const camera = found.renderer.getActiveCamera();
    // Copies: the camera hands out and takes in its own arrays, which turning it writes into.
    if (home === null) home = POSE.map((name) => [...camera.getReferenceByName(name)]);
    POSE.forEach((name, k) => camera.set({ [name]: [...home[k]] }));
    camera.setParallelProjection(true);
    const narrow = Math.max(1, (SHAPE * window.innerHeight) / window.innerWidth);
    camera.setParallelScale(Number(button.dataset.halfHeight) * narrow);
    draw(found);
    atHome = camera.getMTime();
  }

  function turn(found, across, upward) {
    const { camera, position, focus, away, up } = view(found);
    const level = Math.hypot(away[0], away[1]);
    const lift = Math.min(Math.max(Math.atan2(-away[2], level) + upward, -1.55), 1.55);
    const side = level > 1e-6 ? Math.atan2(-away[1], -away[0]) : Math.atan2(up[1], up[0]) + Math.PI;
    const to = [Math.cos(lift) * Math.cos(side + across), Math.cos(lift) * Math.sin(side + across), Math.sin(lift)];
    camera.set({ position: add(focus, to, Math.hypot(...add(position, focus, -1))), viewUp: [0, 0, 1] });
    draw(found);
  }

  function shift(found, right, upward) {
    const seenFrom = view(found);
    const step = add(seenFrom.right.map((x) => 0.2 * right * seenFrom.scale * x), seenFrom.up, 0.2 * upward * seenFrom.scale);
    seenFrom.camera.set({ position: add(seenFrom.position, step), focalPoint: add(seenFrom.focus, step) });
    draw(found);
  }

  function zoom(found, factor) {
    const camera = found.renderer.getActiveCamera();
    camera.setParallelScale(camera.getParallelScale() / factor);
    draw(found);
  }

  // Light or dark, as the system

  function colour({ window_, renderer }) {
    const [ground, ink] = dark.matches ? [[0.08, 0.1, 0.12], 0.92] : [[1, 1, 1], 0.133];
    renderer.setBackground(...ground);
    for (const actor of renderer.getActors()) {
      const property = actor.getProperty();
      if (Math.max(...property.getDiffuseColor()) < INK) inks.add(property);
      if (inks.has(property)) property.setColor(ink, ink, ink);
    }
    window_.render();
  }

  // Poses

  function asked(point) { return point[3] < 0 ? Infinity : point[3]; }

  function words(number) {
    const [x, y, z] = points[number].map((one) => Number(one.toPrecision(4)));
    const value = points[number][3], shown = Number(value.toPrecision(3));
    const text = value < 0 ? reasons[-value - 1] || "no value" : `${title} ${shown} ${unit}`.trim();
    return `${text} at x ${x} m, y ${y} m, z ${z} m`;
  }

  // Half the faces of a grid, and the other half, as numbers of points
  function trianglesOf({ columns, points: own }, index) {
    const first = grids.slice(0, index).reduce((sum, grid) => sum + grid.points.length, 0);
    const found = [];
    for (let k = 0; columns > 1 && k + columns < own.length; k += 1) {
      if ((k + 1) % columns === 0) continue;
      const [a, b, c, d] = [k, k + 1, k + columns + 1, k + columns].map((number) => first + number);
      found.push([a, b, c], [a, c, d]);
    }
    return found;
  }

  // Depth of a triangle of pixels under the mouse; endless beside it
  function depthAt([a, b, c], x, y) {
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if (Math.abs(area) < 1e-9) return Infinity;
    const toB = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
    const toC = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
    if (toB < 0 || toC < 0 || toB + toC > 1) return Infinity;
    return a[2] + toB * (b[2] - a[2]) + toC * (c[2] - a[2]);
  }

  // The computed pose next to the mouse, on what is seen there; -1 for none
  function poseAt(found, x, y) {
    const seenFrom = view(found);
    const at = points.map((one) => pixel(seenFrom, one));
    let corners = at.map((_, number) => number), front = Infinity;
    for (const triangle of triangles) {
      const depth = depthAt(triangle.map((number) => at[number]), x, y);
      if (depth < front) [front, corners] = [depth, triangle];
    }
    if (triangles.length && front === Infinity) return -1;
    const away = (number) => Math.hypot(at[number][0] - x, at[number][1] - y);
    const best = corners.reduce((one, other) => (away(other) < away(one) ? other : one));
    return triangles.length || away(best) < NEAR_PX ? best : -1;
  }

  function pick(number) {
    chosen = number;
    picked.textContent = number < 0 ? "" : words(number);
    mark.hidden = number < 0;
    seen = "";
  }

  function step(by) {
    const at = ranked.indexOf(chosen);
    pick(ranked[(chosen < 0 ? (by > 0 ? 0 : ranked.length - 1) : at + by + ranked.length) % ranked.length]);
  }

  function point(found, x, y) {
    const number = poseAt(found, x, y);
    pointed.hidden = near_.hidden = number < 0;
    if (number < 0) return;
    put(near_, pixel(view(found), points[number]));
    pointed.textContent = words(number);
    pointed.style.left = Math.min(x + 14, Math.max(window.innerWidth - 190, 0)) + "px";
    pointed.style.top = Math.min(y + 14, window.innerHeight - 60) + "px";
  }

  function reset(found) {
    pick(-1);
    pointed.hidden = near_.hidden = true;
    goHome(found);
  }

  function follow() {
    const found = stage();
    if (found) {
      if (home === null) {
        colour(found);
        goHome(found);
      }
      const shape = window.innerWidth + "x" + window.innerHeight;
      const state = shape + "/" + found.renderer.getActiveCamera().getMTime();
      if (state !== seen) place(view(found));
      seen = state;
    }
    window.requestAnimationFrame(follow);
  }

  function place(seenFrom) {
    labels.forEach((label) => put(label, pixel(seenFrom, label.dataset.at.split(",").map(Number))));
    if (chosen >= 0) put(mark, pixel(seenFrom, points[chosen]));
  }

  function put(element, [x, y]) {
    element.style.left = x + "px";
    element.style.top = y + "px";
  }

  const KEYS = {
    ArrowLeft: (found, moves) => (moves ? shift(found, -1, 0) : turn(found, -TURN, 0)),
    ArrowRight: (found, moves) => (moves ? shift(found, 1, 0) : turn(found, TURN, 0)),
    ArrowUp: (found, moves) => (moves ? shift(found, 0, 1) : turn(found, 0, TURN)),
    ArrowDown: (found, moves) => (moves ? shift(found, 0, -1) : turn(found, 0, -TURN)),
    "+": (found) => zoom(found, 1.2), "=": (found) => zoom(found, 1.2), "-": (found) => zoom(found, 1 / 1.2),
    n: () => step(1), p: () => step(-1), Escape: () => pick(-1), Home: reset,
  };

  function key(event) {
    if (event.key === "Tab" || event.ctrlKey || event.metaKey || event.altKey) return;
    const onButton = event.target === button || event.target === shield;
    if (onButton && (event.key === "Enter" || event.key === " ")) return;
    event.stopPropagation(); // the viewer has keys of its own, which would change how it draws
    const found = stage();
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (event.type !== "keydown" || !found || !KEYS[name]) return;
    event.preventDefault();
    shield.hidden = true;
    KEYS[name](found, event.shiftKey);
  }

  const withStage = (act) => (event) => { const found = stage(); if (found) act(found, event); };
  const isCovered = () => shield.hidden === false;
  ["keydown", "keypress", "keyup"].forEach((kind) => window.addEventListener(kind, key, true));
  window.addEventListener("pointermove", withStage((found, event) => {
    if (!isCovered() && event.buttons === 0) point(found, event.clientX, event.clientY);
    else pointed.hidden = near_.hidden = true;
  }), true);
  window.addEventListener("pointerdown", (event) => {
    const isScene = !isCovered() && event.target !== button;
    press = isScene ? [event.clientX, event.clientY] : null;
  }, true);
  window.addEventListener("pointerup", withStage((found, event) => {
    const [x, y] = [event.clientX, event.clientY];
    if (press && Math.hypot(x - press[0], y - press[1]) < 4) pick(poseAt(found, x, y));
    press = null;
  }), true);
  window.addEventListener("resize", withStage((found) => {
    if (found.renderer.getActiveCamera().getMTime() === atHome) goHome(found);
    else draw(found);
  }));
  dark.addEventListener("change", withStage(colour));
  button.addEventListener("click", withStage(reset));
  shield.addEventListener("click", () => {
    shield.hidden = true;
    document.querySelector(".content").focus();
  });
  document.documentElement.addEventListener("mouseleave", () => {
    shield.hidden = false;
    pointed.hidden = near_.hidden = true;
  });
  follow();
})();
