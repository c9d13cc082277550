#include "tests/server/service/hostile_requests.h"

#include <algorithm>
#include <random>
#include <string_view>

namespace trapeze::testing {
namespace {

using namespace std::string_literals;
using Random = std::mt19937_64;

constexpr std::size_t kLongestRequest = 100'000;

std::string get(const std::string& target, const std::string& more = {}) {
  return "GET " + target + " HTTP/1.1\r\nHost: a\r\n" + more + "\r\n";
}

/// Messages that are wrong in other places than the target alone.
std::vector<std::string> hostile_messages() {
  const std::string tile = "/tiles/rings/0/0/0.png";
  return {
      // Not HTTP at all.
      "\r\n\r\n"s,
      "\0\0\0\0\r\n\r\n"s,
      "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"s,
      "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"s,
      "SSH-2.0-OpenSSH_9.2\r\n"s,
      "GET\r\n\r\n"s,
      "GET / HTTP/0.9\r\n\r\n"s,
      "GET /\r\n\r\n"s,
      "GET / HTTP/1.1.1\r\nHost: a\r\n\r\n"s,
      "GET  /  HTTP/1.1\r\nHost: a\r\n\r\n"s,
      " GET / HTTP/1.1\r\nHost: a\r\n\r\n"s,
      std::string(20'000, 'A'),
      std::string(70'000, '\n'),
      // Methods.
      "TRACE / HTTP/1.1\r\nHost: a\r\n\r\n"s,
      "CONNECT a:80 HTTP/1.1\r\nHost: a\r\n\r\n"s,
      "OPTIONS * HTTP/1.1\r\nHost: a\r\n\r\n"s,
      "G\xc3\x84T / HTTP/1.1\r\nHost: a\r\n\r\n"s,
      std::string(5'000, 'G') + " / HTTP/1.1\r\nHost: a\r\n\r\n",
      "POST " + tile + " HTTP/1.1\r\nHost: a\r\nContent-Length: 4\r\n\r\nfill",
      // The end of a request, which request smuggling exploits.
      "POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\nTransfer-Encoding: "
      "chunked\r\n\r\n0\r\n\r\nGET "
      "/health HTTP/1.1\r\nHost: a\r\n\r\n"s,
      "POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked, identity\r\n\r\n0\r\n\r\n"s,
      "POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: xchunked\r\n\r\n0\r\n\r\n"s,
      "POST /values HTTP/1.1\r\nHost: a\r\nContent-Length: 16\r\n\r\nk,v\na,1\nb,1e999\n"s,
      "POST /values HTTP/1.1\r\nHost: a\r\nContent-Length: 16\r\n\r\n[{\"k\":\"\xff\",\"v\":0}"s,
      "POST /values HTTP/1.1\r\nHost: a\r\nContent-Length: 99999999999999999999\r\n\r\nk,v\n"s,
      "POST /values HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n800001\r\nk,v\n"s,
      "POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\nffffffffffffffff1\r\n"s,
      "POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n-1\r\n\r\n"s,
      get("/", "Content-Length: 5\r\nContent-Length: 6\r\n") + "abcdef",
      get("/", "Content-Length: -1\r\n"),
      get("/", "Content-Length: +1\r\n") + "a",
      get("/", "Content-Length: 18446744073709551616\r\n"),
      get("/", "Content-Length : 0\r\n"),
      get("/", "Expect: 100-continue\r\nContent-Length: 1000\r\n"),
      get("/", "Upgrade: websocket\r\nConnection: Upgrade\r\n"),
      get("/", "Connection: close, keep-alive, \x01\r\n"),
      // Header fields.
      get("/", "X: " + std::string(7'000, 'x') + "\r\n"),
      get("/", "X: " + std::string(9'000, 'x') + "\r\n"),
      get("/", " folded: yes\r\n"),
      get("/", "X: a\r\n b\r\n"),
      get("/", "No colon\r\n"),
      get("/", ": no name\r\n"),
      get("/", "X\0Y: z\r\n"s),
      get("/", "X: \x1b[2J\r\n"),
      get(tile, "If-None-Match: " + std::string(7'000, ',') + "\r\n"),
      get(tile, "If-None-Match: \"\r\n"),
      get(tile, "If-None-Match: W/W/\"\"\r\n"),
      get("/catalog", "Accept-Encoding: " + std::string(7'000, ',') + "\r\n"),
      get("/catalog", "Accept-Encoding: gzip;q=1e999;q=, br;;;q=-nan, *;q=\x7f\r\n"),
      get("/wmts.xml", "Accept-Encoding: gzip\r\nAccept-Encoding: br;q=0\r\n"),
      get(tile, "Range: bytes=0-,0-,0-,0-\r\n"),
      get(tile, "Accept-Encoding: gzip;q=-1, *;q=nan\r\n"),
      get(tile, "X-Forwarded-For: 1.2.3.4, \x7f, ::::, " + std::string(5'000, '1') + "\r\n"),
      "GET /\rHTTP/1.1\rHost: a\r\r"s,
      "GET / HTTP/1.1\nHost: a\n\n"s,
      // Hosts.
      "GET /catalog HTTP/1.1\r\n\r\n"s,
      "GET /catalog HTTP/1.1\r\nHost: \r\n\r\n"s,
      "GET /catalog HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"s,
      "GET /catalog HTTP/1.1\r\nHost: a/../b\r\n\r\n"s,
      "GET /catalog HTTP/1.1\r\nHost: \"><script>\r\n\r\n"s,
      "GET /catalog HTTP/1.1\r\nHost: user@evil.example\r\n\r\n"s,
      "GET /catalog HTTP/1.1\r\nHost: a:999999\r\n\r\n"s,
      "GET /catalog HTTP/1.1\r\nHost: [::1\r\n\r\n"s,
      "GET /wmts.xml HTTP/1.1\r\nHost: " + std::string(4'000, 'h') + "\r\n\r\n",
      "GET http://evil.example/catalog HTTP/1.1\r\nHost: a\r\n\r\n"s,
      "GET https://evil.example HTTP/1.1\r\nHost: a\r\n\r\n"s,
      "GET //evil.example/catalog HTTP/1.1\r\nHost: a\r\n\r\n"s,
      // Several requests in one message.
      get(tile) + get("/nosuch") + "garbage\r\n\r\n",
      get("/health") + "\r\n\r\n" + get("/health"),
      get(tile) + "GET /tiles/rings/1/0/0.png HT",
  };
}

std::size_t pick(Random& random, std::size_t below) {
  return std::uniform_int_distribution<std::size_t>(0, below - 1)(random);
}

void insert_trouble(std::string& request, Random& random) {
  static const std::vector<std::string> trouble = {
      "%00",      "%",    "%2",      "%2f",   "%2e%2e", "%252e", "%c0%af",   "%ff",  "..",
      "../",      "\\",   "//",      ";",     "#",      "?",     "&",        "=",    "&&==",
      "@9x",      ".png", ",,,,",    "-0",    "00",     "-1",    "+1",       "1e9",  "0x1",
      "99999999", "nan",  "inf",     "\r\n",  "\n",     "\r",    "\t",       " ",    "\x7f",
      "\xff",     "\xc3", "\xf0",    "rgba(", "fill=",  "url(",  "&fill=#f", "a.b=", "\0"s,
      ":",        "$",    "${HOME}", "'--",   "<svg>"};
  request.insert(pick(random, request.size() + 1), trouble[pick(random, trouble.size())]);
}

void mutate(std::string& request, Random& random) {
  if (request.empty()) request = "GET / HTTP/1.1\r\n\r\n";
  const std::size_t at = pick(random, request.size());
  const std::size_t length = pick(random, std::min<std::size_t>(request.size() - at, 64)) + 1;
  switch (pick(random, 7)) {
    case 0:
      request[at] = static_cast<char>(pick(random, 256));
      break;
    case 1:
      request.erase(at, length);
      break;
    case 2:
      request.insert(at, request.substr(at, length));
      break;
    case 3:
      request.resize(at);
      break;
    case 4:
      request.insert(at, std::string(1 + pick(random, 300), request[at]));
      break;
    default:
      insert_trouble(request, random);
  }
}

}  // namespace

const std::vector<std::string>& hostile_targets() {
  static const std::vector<std::string> targets = {
      // Paths out of the viewer's folder.
      "/../../../../etc/passwd",
      "/..%2f..%2f..%2fetc%2fpasswd",
      "/%2e%2e/%2e%2e/etc/passwd",
      "/%252e%252e/etc/passwd",
      "/..%c0%af..%c0%afetc/passwd",
      "/....//....//etc/passwd",
      "/..\\..\\windows\\win.ini",
      "/.git/config",
      "/.env",
      "//etc/passwd",
      "///",
      "/./index.html",
      "/index.html/..",
      "/index.html%00.png",
      "/index.html/",
      "/tiles/../index.html",
      "/%2f%2f",
      // Malformed tile addresses.
      "/tiles/rings/0/0/0.png/",
      "/tiles//0/0/0.png",
      "/tiles/rings/0/0/.png",
      "/tiles/rings/0/0/0.png%00",
      "/tiles/rings/-1/0/0.png",
      "/tiles/rings/0/1/0.png",
      "/tiles/rings/25/0/0.png",
      "/tiles/rings/00/0/0.png",
      "/tiles/rings/1e1/0/0.png",
      "/tiles/rings/24/16777216/0.png",
      "/tiles/rings/4294967296/4294967296/4294967296.png",
      "/tiles/rings/999999999999999999999999/0/0.png",
      "/tiles/rings/0/0/0@0x.png",
      "/tiles/rings/0/0/0@9x.png",
      "/tiles/rings/0/0/0@999999999x.png",
      "/tiles/rings/0/0/0@2x@2x.png",
      "/tiles/rings/0/0/0.jpg",
      "/tiles/rings/0/0/0",
      "/tiles/nosuch/0/0/0.png",
      "/tiles/rings,/0/0/0.png",
      "/tiles/rings%2cwest/0/0/0.png",
      "/tiles/rings%2f..%2fwest/0/0/0.png",
      "/tiles/r\xc3\xadngs/0/0/0.png",
      "/tiles/a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p,q,r,s,t/0/0/0.png",
      "/tiles/" + std::string(3'000, 'a') + "/0/0/0.png",
      // Malformed styles.
      "/tiles/rings/0/0/0.png?fill",
      "/tiles/rings/0/0/0.png?fill=",
      "/tiles/rings/0/0/0.png?fill=%23%23",
      "/tiles/rings/0/0/0.png?fill=rgb(1e999,0,0)",
      "/tiles/rings/0/0/0.png?fill=url(file:///etc/passwd)",
      "/tiles/rings/0/0/0.png?fill=red&fill=blue",
      "/tiles/rings/0/0/0.png?fill-opacity=nan",
      "/tiles/rings/0/0/0.png?fill-opacity=1e400",
      "/tiles/rings/0/0/0.png?simplify=-0",
      "/tiles/rings/0/0/0.png?simplify=0x10",
      "/tiles/rings/0/0/0.png?simplify=1e-400",
      "/tiles/rings/0/0/0.png?rings.rings.fill=red",
      "/tiles/rings/0/0/0.png?nosuch.fill=red",
      "/tiles/rings/0/0/0.png?.fill=red",
      "/tiles/rings/0/0/0.png?%66ill=red%",
      "/tiles/rings/0/0/0.png?debug=tile,tile,tile,mesh,",
      "/tiles/rings/0/0/0.png?" + std::string(3'000, '&'),
      "/tiles/rings/0/0/0.png?a=" + std::string(5'000, 'a'),
      "/tiles/rings/0/0/0.png?file=/etc/passwd",
      "/tiles/rings/0/0/0.png?filter=1%3D1%3B--",
      "/tiles/rings/0/0/0.png#fragment",
      // Documents.
      "/tiles/.json",
      "/tiles/rings.json?fill=%3Cscript%3E",
      "/legend/rings.exe",
      "/legend/rings@99x.png",
      "/identify/rings/nan,inf",
      "/identify/rings/1e999,-1e999",
      "/identify/rings/7.5,47.6?z=-1",
      "/identify/rings/7.5",
      "/identify/rings/7.5,47.6,1",
      "/values/rings/rank?bbox=",
      "/values/rings/rank?bbox=1",
      "/values/rings/rank?bbox=nan,0,1e999,inf",
      "/values/rings/" + std::string(3'000, 'a'),
      "/wmts?service=WMTS&request=GetTile&layer=rings&tilematrix=../0&tilerow=0&tilecol=0",
      "/wmts?SERVICE=%00",
      "/wmts?service=WMTS&request=GetTile&version=1.0.0&layer=rings&style=default&format=image/png"
      "&tilematrixset=WebMercatorQuad&tilematrix=99999999999999999999&tilerow=0&tilecol=0",
      "/wmts/rings/default/WebMercatorQuad/0/0/0/999999999999/-1.json",
      "/wmts/rings/default/WebMercatorQuad/0/0/0/0/..html",
      "/wmts/%3Cscript%3E/default/WebMercatorQuad/0/0/0.png",
      "/wmts/1.0.0/../../etc/passwd",
      "/wmts?request=GetCapabilities&request=GetTile",
      "/map/rings.png?bbox=nan,inf,1e999,-1e999",
      "/map/rings.png?bbox=-180,-90,180,90&width=16384&height=16384",
      "/map/rings.png?bbox=-2880,-90,2880,90&width=1&height=16384",
      "/map/rings.png?bbox=0,0,0.0000001,0.0000001&width=16384&height=1024",
      "/map/rings.png?bbox=0,0,1,1&width=99999999999999999999",
      "/map/rings/0,0,-1/0x0.png",
      "/map/rings/0,0,24/16384x1024@4x.png",
      "/map/rings/s/" + std::string(3'000, 's') + ".png?bbox=0,0,1,1",
      "/map/..%2F..%2Fetc%2Fpasswd.png?bbox=0,0,1,1",
      "/wms?service=WMS&request=GetMap&layers=rings&styles=&crs=EPSG:3857&bbox=0,0,1,1&width=16384"
      "&height=16384&format=image/png&exceptions=INIMAGE",
      "/wms?request=GetMap&exceptions=INIMAGE&width=16384&height=16384",
      "/wms?request=GetMap&exceptions=BLANK&width=9&height=9&bgcolor=%3Cscript%3E",
      "/wms?request=GetMap&layers=" + std::string(3'000, ','),
      "/wms?request=GetMap&layers=rings&styles=" + std::string(3'000, ','),
      "/wms?request=%3Cscript%3E&version=%3C%26",
      "/wms?request=GetMap&request=GetCapabilities",
      "/wms?service=WMS&request=GetMap&layers=rings&crs=EPSG:3857&bbox=0,0,1e6,1e6&width=100"
      "&height=100&format=image/png&sld=file:///etc/passwd",
      "/ogc/collections/../../etc",
      "/ogc/collections/rings/map/tiles/nosuch/0/0/0",
      "/ogc/tileMatrixSets/%2e%2e",
      "/catalog/../metrics",
      "/metrics?%",
      "/metrics/",
      "*",
      "?",
      "",
      "http://",
      "http:///",
      "javascript:alert(1)",
  };
  return targets;
}

std::vector<std::string> hostile_requests(std::size_t count, std::uint64_t seed) {
  std::vector<std::string> requests = hostile_messages();
  for (const std::string& target : hostile_targets()) requests.push_back(get(target));
  const std::size_t by_hand = requests.size();
  Random random(seed);
  while (requests.size() < count) {
    std::string request = requests[pick(random, by_hand)];
    for (std::size_t i = 1 + pick(random, 4); i > 0; --i) mutate(request, random);
    if (request.size() > kLongestRequest) request.resize(kLongestRequest);
    requests.push_back(std::move(request));
  }
  return requests;
}

}  // namespace trapeze::testing
