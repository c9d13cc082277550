# Tiles are kept under keys, to be purged by layer and place: docs/caching.md. Needs xkey (Debian:
# varnish-modules). For trapeze.vcl, directly below its first lines:
#
#   include "/etc/varnish/purge.vcl";
import xkey;

# "/tiles/land,parcels/12/2204/1433.png" is kept under land/12/2204/1433, parcels/12/2204/1433, land and
# parcels; so is the same in a style by name.
sub vcl_backend_response {
    if (bereq.url ~ "^/tiles/[^/]+/(s/[^/]+/)?[0-9]+/[0-9]+/[0-9]+") {
        set bereq.http.x-layers =
            regsuball(regsub(bereq.url, "^/tiles/([^/]+)/.*$", "\1"), "(,|%2[Cc])", " ") + " ";
        set bereq.http.x-place =
            regsub(bereq.url, "^/tiles/[^/]+/(s/[^/]+/)?([0-9]+/[0-9]+/[0-9]+).*$", "\2");
        set beresp.http.xkey = bereq.http.x-layers +
            regsuball(bereq.http.x-layers, "([^ ]+) ", "\1/" + bereq.http.x-place + " ");
    }
}

sub vcl_deliver {
    unset resp.http.xkey;
}

# Soft: what is purged is still answered with while it is fetched anew.
sub vcl_recv {
    if (req.method == "PURGE" && client.ip == "127.0.0.1") {
        set req.http.x-gone = xkey.softpurge(req.http.xkey);
        return (synth(200));
    }
}
