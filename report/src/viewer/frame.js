// Frame: a report in the frame of a page, which cannot look into it. The page sends a port; the report tells its height and
// the files that are dropped on it there. A report in a window of its own gets no port.

function joinPage() {
  const join = ({ source, data, ports: [port] }) => {
    if (source !== parent || source === window || data !== "corehbot-page" || !port) return;
    removeEventListener("message", join);
    // A frame that is hidden has no height.
    const tell = () => { const height = document.body.scrollHeight; if (height) port.postMessage({ height }); };
    new ResizeObserver(tell).observe(document.body);
    for (const name of ["dragover", "dragleave", "drop"]) document.addEventListener(name, e => {
      // The place for a second report has taken it.
      const isTaken = e.defaultPrevented;
      e.preventDefault();
      port.postMessage({ isOver: name === "dragover" && !isTaken, file: name === "drop" && !isTaken ? e.dataTransfer.files[0] : undefined });
    });
    tell();
  };
  addEventListener("message", join);
}
