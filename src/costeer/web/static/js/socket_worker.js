/**
 * The socket in a thread of its own: messages get their time of receipt here, so that
 * drawing does not delay it.
 */

import { now } from "./clock.js";

let socket = null;

function open(address) {
  socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => postMessage({ kind: "open" });
  socket.onmessage = ({ data }) => {
    const received = now();
    const isText = typeof data === "string";
    if (isText) postMessage({ kind: "text", text: data, received });
    else postMessage({ kind: "frames", buffer: data, received }, [data]);
  };
  socket.onclose = ({ code, reason }) => postMessage({ kind: "close", code, reason });
}

onmessage = ({ data }) => {
  if (data.kind === "open") open(data.address);
  else if (socket?.readyState === WebSocket.OPEN) socket.send(data.text);
};
