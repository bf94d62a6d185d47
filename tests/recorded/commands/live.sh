# Running nodes are asked; what they answer is written down here.
cat > nodes.json <<END
{"c0": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "", "written_s": 1.0, "file": "x"}, "name": "c0", "kind": "skin", "role": "cell", "number": 0, "parent": 2, "dist": 1, "load": 12, "ports": [{"port": 0, "path": 1, "cabled": true, "broken": false, "dist": 2, "child": true}, {"port": 1, "path": null, "cabled": false, "broken": false, "dist": 0, "child": false}, {"port": 2, "path": 0, "cabled": true, "broken": false, "dist": 0, "child": false}, {"port": 3, "path": null, "cabled": false, "broken": false, "dist": 0, "child": false}], "paths": [{"port": 0, "own": "udp 127.0.0.1:2", "name": "udp 127.0.0.1:1", "up": true, "heard_s": 0.012, "broken": false, "counters": {"received": 10, "dropped: short": 2}}, {"port": 1, "own": "udp 127.0.0.1:3", "name": "udp 127.0.0.1:4", "up": true, "heard_s": null, "broken": true, "counters": {"received": 0, "unsent": 3, "unplugged": 0}}], "counters": {"frames sent": 5, "samples": 0}}], "listen": [{"ok": true}, {"from": 9, "command": {"time_us": 1234567, "number": 4, "to_all": true, "code": 7, "value": 300, "hops": 2}}, {"from": 9, "command": {"time_us": 1234567, "number": 4, "to_all": false, "code": 7, "value": 300, "hops": 2}}], "cut": [{"ok": true}], "restore": [{"ok": true}]}, "c1": {"status": [{"up_s": 61.5, "sealed": false, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "disk full", "written_s": null, "file": "/s"}, "name": "c1", "kind": "skin", "role": "cell", "number": 1, "parent": null, "dist": null, "load": 1, "ports": [{"port": 0, "path": 0, "cabled": true, "broken": false, "dist": 1, "child": false}, {"port": 1, "path": null, "cabled": false, "broken": false, "dist": 0, "child": false}, {"port": 2, "path": null, "cabled": false, "broken": false, "dist": 0, "child": false}, {"port": 3, "path": null, "cabled": false, "broken": false, "dist": 0, "child": false}], "paths": [{"port": 0, "own": "udp 127.0.0.1:4", "name": "udp 127.0.0.1:3", "up": true, "heard_s": 7.0, "broken": true, "counters": {}}], "counters": {}}]}, "pc": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "no room", "written_s": 3.5, "file": "/s"}, "name": "pc", "kind": "skin", "role": "sink", "sq": 4, "cells": [1], "paths": [{"port": 0, "own": "udp 127.0.0.1:1", "name": "udp 127.0.0.1:2", "up": false, "heard_s": 0.5, "broken": false, "counters": {}}], "counters": {"frames sent": 8}}], "command": [{"number": 5, "ports": 2}], "listen": [{"from": 1, "touch": {"time_us": 1234567, "seq": 3, "hops": 2, "port": 0, "proximity": 99, "force": [1, 2, 3], "temperature": 13}}]}, "lone": {"command": [{"number": 6, "ports": 0}]}, "one": {"command": [{"number": 7, "ports": 1}]}, "c9": {}}
END
live status
live status --json
live status c0 pc
live status c0 --json
live status c9
live listen c0
live listen c0 --count 1 --json
live listen pc --in-order
live command pc 7 300
live command pc 7 300 --cell 2
live command pc 7 --json
live command lone 1
live command one 1
live command c0 1
live cut c0 1
live cut c0 1 --restore
live cut c1 1
cat > nodes.json <<END
{"n0": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "", "written_s": 1.0, "file": "x"}, "name": "n0", "kind": "mesh", "role": "gateway", "number": 0, "gateway": 0, "epoch": 3, "table": 9, "round": 1, "neighbours": [{"node": 1, "quality": 0.987, "suspect": false, "ports": [0, 1]}, {"node": 2, "quality": null, "suspect": true, "ports": [1]}], "routes": {"1": [1, 2], "2": [1, 255]}, "onward": [], "gives_back": true, "queue": 1, "round_trip_ms": 12.5, "waiting": {"2": 3}, "alarms": [{"kind": "cross", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 2.25}, {"kind": "lost", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 0.04}], "paths": [{"port": 0, "own": "udp a", "name": "udp b", "up": true, "heard_s": 0.1, "broken": false, "counters": {}}], "counters": {"messages received": 4}}], "send": [{"state": "accepted", "reason": ""}, {"state": "delivered", "reason": ""}], "listen": [{"from": 3, "payload": "6869ff"}, {"from": 3, "alarm": {"kind": "cross", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 2.25}}, {"from": 3, "alarm": {"kind": "lost", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 2.25}}]}, "n1": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "", "written_s": 1.0, "file": "x"}, "name": "n1", "kind": "mesh", "role": "node", "number": 1, "gateway": null, "epoch": 3, "table": 0, "round": 1, "neighbours": [{"node": 0, "quality": 1.0, "suspect": false, "ports": [0]}], "routes": {}, "onward": [], "gives_back": true, "queue": 0, "round_trip_ms": 12.5, "robot": {"at_cm": [105, -20], "fence": "inside"}, "paths": [{"port": 0, "own": "udp b", "name": "udp a", "up": true, "heard_s": 0.1, "broken": false, "counters": {}}], "counters": {}}], "send": [{"state": "accepted", "reason": ""}, {"state": "expired", "reason": "no way"}]}, "full": {"send": [{"state": "refused", "reason": "queue full"}]}, "dead": {"send": []}}
END
live status n0 n1
live send n0 1 hello
live send n0 1 hello --json --priority
live send n0 255 hello
live send n0 1 hello --no-reliable --in-order
live send n1 0 -hello
live send full 0 x
live send dead 0 x
live listen n0 --count 2
live listen n0
live listen n0 --count 3 --json
cat > nodes.json <<END
{"s0": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "", "written_s": 1.0, "file": "x"}, "name": "s0", "kind": "radio", "role": "station", "number": 0, "mode": 0, "place": null, "queued": 2, "radio": "off", "timing": {"slot_us": 500, "packet_slots": 100, "ta_us": 100, "dmax_us": 50}, "paths": [{"port": 0, "own": "", "name": "air", "up": true, "heard_s": 0.1, "broken": false, "counters": {}}], "counters": {"frames sent": 4, "packets delivered": 2, "packets accepted": 4}}]}, "s1": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "", "written_s": 1.0, "file": "x"}, "name": "s1", "kind": "radio", "role": "station", "number": 1, "mode": 0, "place": 1, "queued": 0, "radio": "off", "timing": {"slot_us": 500, "packet_slots": 100, "ta_us": 100, "dmax_us": 50}, "paths": [{"port": 0, "own": "", "name": "air", "up": true, "heard_s": 0.1, "broken": false, "counters": {}}], "counters": {"packets accepted": 1}}]}}
END
live status
live status s0
cat > nodes.json <<END
{}
END
live status
live status --json
live capture
cat > nodes.json <<END
{"n0": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "", "written_s": 1.0, "file": "x"}, "name": "n0", "kind": "mesh", "role": "gateway", "number": 0, "gateway": 0, "epoch": 3, "table": 9, "round": 1, "neighbours": [{"node": 1, "quality": 0.987, "suspect": false, "ports": [0, 1]}, {"node": 2, "quality": null, "suspect": true, "ports": [1]}], "routes": {"1": [1, 2], "2": [1, 255]}, "onward": [], "gives_back": true, "queue": 1, "round_trip_ms": 12.5, "waiting": {"2": 3}, "alarms": [{"kind": "cross", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 2.25}, {"kind": "lost", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 0.04}], "paths": [{"port": 0, "own": "udp a", "name": "udp b", "up": true, "heard_s": 0.1, "broken": false, "counters": {}}], "counters": {"messages received": 4}}], "send": [{"state": "accepted", "reason": ""}, {"state": "delivered", "reason": ""}], "listen": [{"from": 3, "payload": "6869ff"}, {"from": 3, "alarm": {"kind": "cross", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 2.25}}, {"from": 3, "alarm": {"kind": "lost", "robot": 3, "reporter": 3, "number": 1, "x_cm": 150, "y_cm": -220, "margin_cm": -30, "ago_s": 2.25}}]}, "s0": {"status": [{"up_s": 61.5, "sealed": true, "keys": {"use": 1, "accepted": [1]}, "state": {"trouble": "", "written_s": 1.0, "file": "x"}, "name": "s0", "kind": "radio", "role": "station", "number": 0, "mode": 0, "place": null, "queued": 2, "radio": "off", "timing": {"slot_us": 500, "packet_slots": 100, "ta_us": 100, "dmax_us": 50}, "paths": [{"port": 0, "own": "", "name": "air", "up": true, "heard_s": 0.1, "broken": false, "counters": {}}], "counters": {"frames sent": 4, "packets delivered": 2, "packets accepted": 4}}]}}
END
live status
