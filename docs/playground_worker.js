// SPDX-License-Identifier: Apache-2.0
// What runs the playground's code: Python in a worker of the browser.
"use strict";

const MAX_OUTPUT = 100_000; // characters of one run, which the page can still show
const FILE = "example.py"; // the name of the code in tracebacks
let python = null; // the promise of Pyodide with the library
let printed = 0;

function say(kind, text) {
  postMessage({ kind, text });
}

function output(text) {
  if (printed < MAX_OUTPUT) say("output", text.slice(0, MAX_OUTPUT - printed));
  printed += text.length;
}

// A traceback without the lines of Pyodide and of the library, which would hide the error on a phone.
function shortened(traceback) {
  return traceback
    .split(/^(?=  File ")/m)
    .map((part) => (part.startsWith(`  File "${FILE}"`) ? part : part.replace(/^(?: .*\n)+/, "")))
    .join("");
}

// Pyodide waits for ever where one of its files does not load, so a failed request ends the run.
function watched(request) {
  return async (resource, options) => {
    let problem;
    try {
      const response = await request(resource, options);
      if (response.ok) return response;
      problem = `status ${response.status}`;
    } catch (error) {
      problem = error.message;
    }
    const text = `${resource.url ?? resource} does not load: ${problem}`;
    say("failed", text);
    throw new Error(text);
  };
}

async function load(pyodide, wheel) {
  say("status", "Loading Python");
  const request = self.fetch;
  self.fetch = watched(request);
  importScripts(`${pyodide}pyodide.js`);
  const loaded = await loadPyodide({ indexURL: pyodide, env: { CONTACT_DYNAMICS_PLAIN: "1" } });
  say("status", "Loading NumPy and SciPy");
  await loaded.loadPackage(["numpy", "scipy"]);
  say("status", "Loading contact_dynamics");
  loaded.unpackArchive(await (await fetch(wheel)).arrayBuffer(), "wheel");
  self.fetch = request;
  const decoder = new TextDecoder();
  const write = (bytes) => {
    output(decoder.decode(bytes, { stream: true }));
    return bytes.length;
  };
  loaded.setStdout({ write });
  loaded.setStderr({ write });
  return loaded;
}

onmessage = async ({ data: { pyodide, wheel, code } }) => {
  let loaded;
  try {
    python ??= load(pyodide, wheel);
    loaded = await python;
  } catch (error) {
    say("failed", error.message);
    return;
  }
  say("status", "Running");
  printed = 0;
  const began = performance.now();
  const globals = loaded.toPy({ __name__: "__main__" });
  let failed = false;
  try {
    loaded.runPython(code, { globals, filename: FILE });
  } catch (error) {
    failed = true;
    output(shortened(error.message));
  }
  globals.destroy();
  loaded.runPython("import sys; sys.stdout.flush(); sys.stderr.flush()");
  if (printed > MAX_OUTPUT) say("output", `\n… ${printed - MAX_OUTPUT} more characters`);
  const seconds = ((performance.now() - began) / 1000).toFixed(2);
  say("done", `${failed ? "Failed" : "Done"} after ${seconds} s`);
};
