# Varnish in front of several servers: each tile is drawn by one of them, and all share this cache.
#
#   varnishd -a :80 -f /etc/varnish/trapeze.vcl -s malloc,2g
vcl 4.1;

import directors;
import std;

probe ready {
    .url = "/ready";
    .interval = 1s;
    .timeout = 1s;
    .window = 3;
    .threshold = 2;
}

backend trapeze_1 {
    .host = "127.0.0.1";
    .port = "8081";
    .probe = ready;
    .connect_timeout = 1s;
    .first_byte_timeout = 15s;  # longer than deadline_ms
}

backend trapeze_2 {
    .host = "127.0.0.1";
    .port = "8082";
    .probe = ready;
    .connect_timeout = 1s;
    .first_byte_timeout = 15s;
}

backend trapeze_3 {
    .host = "127.0.0.1";
    .port = "8083";
    .probe = ready;
    .connect_timeout = 1s;
    .first_byte_timeout = 15s;
}

backend trapeze_4 {
    .host = "127.0.0.1";
    .port = "8084";
    .probe = ready;
    .connect_timeout = 1s;
    .first_byte_timeout = 15s;
}

sub vcl_init {
    new trapeze = directors.shard();
    trapeze.add_backend(trapeze_1);
    trapeze.add_backend(trapeze_2);
    trapeze.add_backend(trapeze_3);
    trapeze.add_backend(trapeze_4);
    trapeze.reconfigure();
}

sub vcl_recv {
    # Prometheus scrapes each server directly.
    if (req.url ~ "^/metrics") {
        return (synth(404));
    }
    if (req.method != "GET" && req.method != "HEAD") {
        return (pass);
    }
    unset req.http.Cookie;
    # The same parameters in another order give the same tile.
    set req.url = std.querysort(req.url);
    set req.backend_hint = trapeze.backend(by = URL);
}

sub vcl_hash {
    hash_data(req.url);
    # Documents contain absolute URLs; tiles are the same under every host name.
    if (req.url !~ "^/tiles/[^?]*\.png") {
        hash_data(req.http.Host);
    }
    return (lookup);
}

sub vcl_backend_fetch {
    # A retry goes to the next server for this URL.
    if (bereq.retries > 0) {
        set bereq.backend = trapeze.backend(by = URL, alt = bereq.retries);
    }
}

sub vcl_backend_response {
    # The server is busy, or has just started.
    if (beresp.status == 503 && bereq.retries < 2) {
        return (retry);
    }
    # This server has not received the posted style or table of the tile, which a client may have posted to
    # another one. If its id is in the query, the status may be 400.
    if ((beresp.status == 404 || (beresp.status == 400 && bereq.url ~ "[?&=,][0-9a-f]{40}")) && bereq.retries < 3) {
        return (retry);
    }
    if (beresp.status >= 500 || beresp.status == 429) {
        set beresp.uncacheable = true;
        return (deliver);
    }
    # A stale tile is better than none.
    set beresp.grace = 1h;
    set beresp.keep = 7d;  # to revalidate with If-None-Match
}

sub vcl_backend_error {
    if (bereq.retries < 2) {
        return (retry);
    }
}

sub vcl_deliver {
    set resp.http.X-Proxy-Cache = obj.hits > 0;
}
