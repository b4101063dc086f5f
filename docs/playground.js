// SPDX-License-Identifier: Apache-2.0
// The playground: makes an editor of each Python block on its page. A worker runs the code, so that the page stays
// responsive and a run can be stopped. The addresses of Pyodide and of the library's wheel are those that the page names.
"use strict";

(() => {
  const addresses = {
    pyodide: document.querySelector('a[href*="/pyodide/v"]').href,
    wheel: document.querySelector('a[href$="-py3-none-any.whl"]').href,
  };
  const script = new URL("playground_worker.js", document.currentScript.src);
  const examples = [];
  let worker = null; // it loads Python at its first run, and keeps it
  let running = null; // the example that runs

  function element(name, properties) {
    return Object.assign(document.createElement(name), properties);
  }

  function finish(status) {
    running.status.textContent = status;
    running.output.scrollTop = running.output.scrollHeight; // an error is explained in its last line
    running = null;
    for (const each of examples) {
      each.run.textContent = "Run";
      each.run.disabled = false;
    }
  }

  function stop(status) {
    if (worker) {
      worker.onmessage = null; // one that is on its way is of this run
      worker.terminate();
      worker = null;
    }
    finish(status);
  }

  function heard({ data: { kind, text } }) {
    if (kind === "output") running.output.append(text);
    else if (kind === "status") running.status.textContent = text;
    else if (kind === "done") finish(text);
    else stop(text);
  }

  function run(example) {
    if (running) return;
    running = example;
    for (const each of examples) each.run.disabled = each !== example;
    example.run.textContent = "Stop";
    example.output.textContent = "";
    example.status.textContent = "Starting";
    if (location.protocol === "file:") {
      stop("Browsers run this over HTTP only: python -m http.server -d site, then open localhost:8000.");
      return;
    }
    if (!worker) {
      worker = new Worker(script);
      worker.onmessage = heard;
      worker.onerror = (error) => stop(`Python has failed: ${error.message || "no reason is known"}`);
    }
    worker.postMessage({ ...addresses, code: example.editor.value });
  }

  function make(block) {
    const original = block.querySelector("code").textContent.trimEnd();
    let title = block.previousElementSibling;
    while (title && title.tagName !== "H2") title = title.previousElementSibling;
    const example = {
      editor: element("textarea", { value: original, rows: original.split("\n").length + 1, spellcheck: false }),
      run: element("button", { type: "button", textContent: "Run", className: "md-button md-button--primary" }),
      reset: element("button", { type: "button", textContent: "Reset", className: "md-button" }),
      status: element("span", { role: "status" }),
      output: element("pre", { ariaLive: "polite" }),
    };
    example.editor.setAttribute("aria-label", `Code: ${title ? title.firstChild.textContent : "example"}`);
    for (const off of ["autocapitalize", "autocomplete", "autocorrect"]) example.editor.setAttribute(off, "off");
    example.run.onclick = () => (running === example ? stop("Stopped") : run(example));
    example.reset.onclick = () => (example.editor.value = original);
    example.editor.onkeydown = (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
        event.preventDefault();
        run(example);
      }
    };
    const made = element("div", { className: "playground" });
    made.append(example.editor, example.run, example.reset, example.status, example.output);
    block.replaceWith(made);
    examples.push(example);
  }

  document.querySelectorAll(".md-typeset .highlight").forEach(make);
})();
