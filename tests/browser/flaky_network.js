// A proxy between the browser and the host, whose connections can be cut.
"use strict";

const net = require("node:net");

/** Starts a proxy on a free port of 127.0.0.1. `target()` returns the port of the host. */
function startProxy(target) {
  const connections = new Set();
  let forwards = true;
  const server = net.createServer({ allowHalfOpen: false }, (client) => {
    const host = net.connect(target(), "127.0.0.1");
    const connection = { client, host };
    connections.add(connection);
    const close = () => {
      client.destroy();
      host.destroy();
      connections.delete(connection);
    };
    for (const [from, to] of [[client, host], [host, client]]) {
      from.setNoDelay(true);
      // Data that arrives while the network is silent is lost, as on a real network that comes back with another address.
      from.on("data", (data) => (forwards ? to.write(data) : (connection.isBroken = true)));
      from.on("close", close);
      from.on("error", close);
    }
  });
  return new Promise((resolve) => {
    server.listen(0, "127.0.0.1", () =>
      resolve({
        port: server.address().port,
        /** Closes all connections. New ones are accepted. */
        cut() {
          for (const { client, host } of connections) {
            client.destroy();
            host.destroy();
          }
        },
        /** Loses all data without closing a connection. */
        silence() {
          forwards = false;
        },
        /** Forwards data again; connections that lost data are closed. */
        restore() {
          forwards = true;
          for (const { client, host, isBroken } of connections) {
            if (isBroken) [client, host].forEach((socket) => socket.destroy());
          }
        },
        close() {
          this.cut();
          server.close();
        },
      }),
    );
  });
}

module.exports = { startProxy };
