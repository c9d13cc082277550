# Tags cached tiles with keys, so that they can be purged by layer and place: see docs/caching.md. Needs xkey (Debian
# package varnish-modules). Include it in trapeze.vcl, directly below its first lines:
#
#   include "/etc/varnish/purge.vcl";
import xkey;

# "/tiles/land,parcels/12/2204/1433.png" gets the keys land/12/2204/1433, parcels/12/2204/1433, land and
# parcels; the same tile in a named style, and by its addresses of WMTS and OGC API, where the row comes before the
# column, gets the same keys.
sub vcl_backend_response {
    unset bereq.http.x-layers;
    if (bereq.url ~ "^/tiles/[^/]+/(s/[^/]+/)?(WebMercatorQuad/)?[0-9]+/[0-9]+/[0-9]+") {
        set bereq.http.x-layers = regsub(bereq.url, "^/tiles/([^/]+)/.*$", "\1");
        set bereq.http.x-place =
            regsub(bereq.url, "^/tiles/[^/]+/(s/[^/]+/)?(WebMercatorQuad/)?([0-9]+/[0-9]+/[0-9]+).*$", "\3");
    } elsif (bereq.url ~ "^/(wmts/[^/]+/[^/]+|ogc/collections/[^/]+/map/tiles)/WebMercatorQuad/[0-9]+/[0-9]+/[0-9]+") {
        set bereq.http.x-layers = regsub(bereq.url, "^/(wmts|ogc/collections)/([^/]+)/.*$", "\2");
        set bereq.http.x-place = regsub(bereq.url, "^.*/WebMercatorQuad/([0-9]+)/([0-9]+)/([0-9]+).*$", "\1/\3/\2");
    } elsif (bereq.url ~ "^/wmts\?(.*&)?(?i)tilematrixset=WebMercatorQuad(&|$)" && bereq.url ~ "(?i)[?&]layer=") {
        set bereq.http.x-layers = regsub(bereq.url, "(?i)^.*[?&]layer=([^&]*).*$", "\1");
        set bereq.http.x-place = regsub(bereq.url, "(?i)^.*[?&]tilematrix=([0-9]+).*$", "\1") + "/" +
            regsub(bereq.url, "(?i)^.*[?&]tilecol=([0-9]+).*$", "\1") + "/" +
            regsub(bereq.url, "(?i)^.*[?&]tilerow=([0-9]+).*$", "\1");
    }
    if (bereq.http.x-layers) {
        set bereq.http.x-layers = regsuball(bereq.http.x-layers, "(,|%2[Cc])", " ") + " ";
        set beresp.http.xkey = bereq.http.x-layers +
            regsuball(bereq.http.x-layers, "([^ ]+) ", "\1/" + bereq.http.x-place + " ");
    }
}

sub vcl_deliver {
    unset resp.http.xkey;
}

# A soft purge: the old tile is still served while the new one is fetched.
sub vcl_recv {
    if (req.method == "PURGE" && client.ip == "127.0.0.1") {
        set req.http.x-gone = xkey.softpurge(req.http.xkey);
        return (synth(200));
    }
}
