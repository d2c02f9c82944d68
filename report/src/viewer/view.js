// View: the picture as it is seen, saved as a file or as a link, and on the whole screen.

/** Saves a blob as a file. */
function saveBlob(blob, name) {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** What is shown, in the words of a link: where from, which layers, up to which move, in which colours, without which types. */
function viewText(stage, player, colours) {
  const { camera } = stage, round = v => +v.toPrecision(7);
  const words = {
    camera: [...camera.centre, Math.min(camera.width, camera.height) / camera.scale, camera.azimuth, camera.elevation].map(round).join("_"),
    layers: [player.low + 1, player.high + 1].join("-"), move: player.done, colour: colours.id, hidden: player.hidden,
  };
  return "view:" + Object.entries(words).map(([name, value]) => `${name}=${value}`).join("&");
}

/** Shows what a link says; what it does not say, or what cannot be, stays as it is. Returns whether there was a view in it. */
function showView(text, stage, player, colours) {
  if (!text.startsWith("view:")) return false;
  const words = new Map(text.slice(5).split("&").map(word => word.split("="))), number = (name, isFine) => { const v = Number(words.get(name)); return words.has(name) && Number.isInteger(v) && isFine(v) ? v : null; };
  const { camera } = stage;
  player.stop();
  const hidden = number("hidden", v => v >= 0 && v < 2 ** 32);
  if (hidden !== null) { player.hidden = hidden; player.tell("hidden"); }
  const [low, high] = (words.get("layers") ?? "").split("-").map(Number);
  if (Number.isInteger(low) && Number.isInteger(high) && low >= 1 && low <= high) player.setLayers(low - 1, high - 1);
  const move = number("move", v => v >= 0);
  if (move !== null) player.setMove(move);
  colours.choose(words.get("colour"));
  const seen = (words.get("camera") ?? "").split("_").map(Number);
  if (seen.length === 6 && seen.every(Number.isFinite) && seen[3] > 0) {
    const [x, y, z, span, azimuth, elevation] = seen;
    Object.assign(camera, { centre: [x, y, z], scale: clamp(Math.min(camera.width, camera.height) / span, 0.02, 40000), azimuth: ((azimuth % 360) + 360) % 360, elevation: clamp(elevation, 0, 90) });
    player.tell("camera");
  }
  stage.redraw();
  return true;
}

/** The picture with a line of words below, once all of it is drawn. */
async function pictureOf(stage, words) {
  await stage.whole();
  const PAD = 8, ratio = stage.over.width / stage.camera.width, tall = Math.round(24 * ratio), canvas = stage.flat(tall), g = canvas.getContext("2d");
  g.fillStyle = css("--soft"); g.font = `${12 * ratio}px system-ui, sans-serif`; g.textBaseline = "middle";
  g.fillText(words, PAD * ratio, canvas.height - tall / 2, canvas.width - 2 * PAD * ratio);
  // Behind all that is drawn.
  g.globalCompositeOperation = "destination-over"; g.fillStyle = css("--card"); g.fillRect(0, 0, canvas.width, canvas.height);
  return new Promise((go, fail) => canvas.toBlob(blob => blob ? go(blob) : fail(new Error("the browser makes no picture")), "image/png"));
}

/** Buttons that save a view, and one that shows it on the whole screen. */
function saveButtons(stage, player, record, colours, heights) {
  const out = make("output", { role: "status" }), name = record.data.summary.file.split("/").pop(), isFramed = location.protocol === "about:";
  const words = () => {
    const layers = heights.length > 1 ? `, layers ${player.low + 1} to ${player.high + 1} of ${heights.length}` : "";
    return `${name} on ${record.data.summary.machine}: ${colours.name}${layers}, ${clock(player.now)} of ${clock(record.moves.whole)}`;
  };
  const picture = pushButton("Picture", "Save the picture as a PNG file", () => pictureOf(stage, words()).then(blob => { saveBlob(blob, name.replace(/\.[^.]*$/, "") + ".png"); out.textContent = ""; }, error => { out.textContent = error.message; }));
  const link = pushButton("Link", "Copy a link to this view of this file", () => {
    const hash = viewText(stage, player, colours), said = text => { out.textContent = text; };
    location.hash = hash;
    const inBar = () => said("The link is the page\u2019s address now.");
    if (navigator.clipboard) navigator.clipboard.writeText(location.href).then(() => said("The link is copied."), inBar); else inBar();
  });
  // A report in the page with the firmware has no address.
  link.hidden = isFramed;
  const screen = pushButton("Full screen", "Show the picture on the whole screen", () => {
    const view = stage.element.closest(".view");
    // Browsers allow it to a hand alone, and complain of scripts.
    if (navigator.userActivation && !navigator.userActivation.isActive) return;
    const asked = document.fullscreenElement ? document.exitFullscreen() : view.requestFullscreen();
    asked.catch(error => { out.textContent = `No full screen: ${error.message}`; });
  });
  screen.hidden = !document.fullscreenEnabled;
  const follow = () => {
    if (!stage.element.isConnected) { document.removeEventListener("fullscreenchange", follow); return; }
    screen.ariaPressed = String(Boolean(document.fullscreenElement));
  };
  document.addEventListener("fullscreenchange", follow);
  return [buttonGroup("Save the view", picture, link), screen, out];
}
