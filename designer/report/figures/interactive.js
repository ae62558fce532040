// Keeps the labels at their points and the view parallel, and lets a page with this scene in it
// scroll until the scene is asked for: without the shield it would swallow every wheel and swipe.
(function () {
  const POSE = ["position", "focalPoint", "viewUp"];
  const SHAPE = 1.6; // width over height of the picture that the view was fitted to
  const labels = Array.from(document.querySelectorAll(".label"));
  const shield = document.getElementById("shield");
  const button = document.getElementById("home");
  let home = null;
  let seen = "";

  function stage() {
    const window_ = window.global && window.global.renderWindow;
    const renderers = window_ ? window_.getRenderers() : [];
    const renderer = renderers.find((one) => one.getActors().length > 0);
    return renderer ? { window_, renderer } : null; // the viewer's own renderer stays empty
  }

  function goHome({ window_, renderer }) {
    const camera = renderer.getActiveCamera();
    // Copies: the camera hands out and takes in its own arrays, which turning it writes into.
    if (home === null) home = POSE.map((name) => [...camera.getReferenceByName(name)]);
    POSE.forEach((name, k) => camera.set({ [name]: [...home[k]] }));
    camera.setParallelProjection(true);
    const narrow = Math.max(1, (SHAPE * window.innerHeight) / window.innerWidth);
    camera.setParallelScale(Number(button.dataset.halfHeight) * narrow);
    renderer.resetCameraClippingRange();
    window_.render();
  }

  function follow() {
    const found = stage();
    if (found) {
      if (home === null) goHome(found);
      const shape = window.innerWidth + "x" + window.innerHeight;
      const state = shape + "/" + found.renderer.getActiveCamera().getMTime();
      if (state !== seen) labels.forEach((label) => put(found.renderer, label));
      seen = state;
    }
    window.requestAnimationFrame(follow);
  }

  function put(renderer, label) {
    const at = label.dataset.at.split(",").map(Number);
    const shape = window.innerWidth / window.innerHeight;
    const [x, y] = renderer.worldToNormalizedDisplay(at[0], at[1], at[2], shape);
    label.style.left = 100 * x + "%";
    label.style.top = 100 * (1 - y) + "%";
  }

  button.addEventListener("click", () => { const found = stage(); if (found) goHome(found); });
  window.addEventListener("resize", () => { const found = stage(); if (found) goHome(found); });
  shield.addEventListener("click", () => { shield.hidden = true; });
  document.documentElement.addEventListener("mouseleave", () => { shield.hidden = false; });
  follow();
})();
