// draft FreeSewing garments -> polyline pieces (mm, y up, CCW), named edges, seams
import fs from 'fs'
import { Teagan } from '@freesewing/teagan'
import { Aaron } from '@freesewing/aaron'
import { Penelope } from '@freesewing/penelope'
import { Sandy } from '@freesewing/sandy'
import * as models from '@freesewing/models'
const r2 = v => Math.round(v*100)/100
const SEG = +(process.env.SEG||12)
// cubic sample -> n segments of about SEG mm
function sampleOps(path){            // list of edges [{from,to,pts}] per op, in path order
  const out=[]; let cur=null, start=null
  for(const o of path.ops){
    if(o.type==='move'){cur=o.to;start=o.to;continue}
    if(o.type==='close'){ if(start&&Math.hypot(cur.x-start.x,cur.y-start.y)>0.01) out.push({from:cur,to:start,pts:[[cur.x,cur.y],[start.x,start.y]],kind:'line'}); continue }
    if(Math.hypot(o.to.x-cur.x,o.to.y-cur.y)<0.01){cur=o.to;continue}
    if(o.type==='line'){out.push({from:cur,to:o.to,pts:[[cur.x,cur.y],[o.to.x,o.to.y]],kind:'line'})}
    else { const P=[cur,o.cp1,o.cp2,o.to]; const B=t=>{const s=1-t;return ['x','y'].map(k=>s*s*s*P[0][k]+3*s*s*t*P[1][k]+3*s*t*t*P[2][k]+t*t*t*P[3][k])}
      let L=0,pv=B(0);const T=[[0,0]];for(let i=1;i<=400;i++){const q=B(i/400);L+=Math.hypot(q[0]-pv[0],q[1]-pv[1]);pv=q;T.push([i/400,L])}
      const n=Math.max(1,Math.round(L/SEG)),pts=[];let j=0
      for(let i=0;i<=n;i++){const want=L*i/n;while(j<T.length-2&&T[j+1][1]<want)j++;const a=T[j],b=T[j+1];const f=b[1]>a[1]?(want-a[1])/(b[1]-a[1]):0;pts.push(B(a[0]+(b[0]-a[0])*Math.min(1,Math.max(0,f))))}
      out.push({from:cur,to:o.to,pts,kind:'curve'}) }
    cur=o.to
  }
  return out
}
const nameOf=(part,p,pref)=>{const c=Object.entries(part.points).filter(([k,q])=>!k.startsWith('_')&&Math.abs(q.x-p.x)<0.02&&Math.abs(q.y-p.y)<0.02).map(e=>e[0]);for(const k of pref)if(c.includes(k))return k;return c[0]||`p${r2(p.x)}_${r2(p.y)}`}
const len=p=>{let L=0;for(let i=1;i<p.length;i++)L+=Math.hypot(p[i][0]-p[i-1][0],p[i][1]-p[i-1][1]);return L}
// build a piece. edges: [[edgeName, [pointname chain...]]...] groups consecutive ops by named vertex
function piece(name,part,path,pref,groups,fold,info){
  const ops=sampleOps(path)
  const names=ops.map(o=>[nameOf(part,o.from,pref),nameOf(part,o.to,pref)])
  const E=[]
  for(const [en,a,b] of groups){            // edge from named point a to b along path
    let i=names.findIndex(n=>n[0]===a); if(i<0)throw new Error(`${name}.${en}: no ${a} in ${JSON.stringify(names)}`)
    let pts=[ops[i].pts[0]],guard=0
    for(;;){pts=pts.concat(ops[i].pts.slice(1)); if(names[i][1]===b)break; i=(i+1)%ops.length; if(guard++>40)throw new Error(`${name}.${en} no end ${b} in ${JSON.stringify(names)}`)}
    E.push({name:en,from:a,to:b,pts:pts.map(([x,y])=>[x,-y])})
  }
  if(fold){ // drop the fold edge, mirror the rest about x=0
    const keep=E.filter(e=>e.name!=='fold'); const fi=E.findIndex(e=>e.name==='fold')
    const ord=[]; for(let k=1;k<E.length;k++)ord.push(E[(fi+k)%E.length])     // starts after fold
    const mir=ord.slice().reverse().map(e=>({name:e.name+'_r',from:e.to+'_m',to:e.from+'_m',pts:e.pts.slice().reverse().map(([x,y])=>[-x,y])}))
    const lef=ord.map(e=>({...e,name:e.name+'_l'}))
    E.length=0; E.push(...lef,...mir)
    // merge the two halves of the edges that touch the fold into one edge (hem, neck)
    const mergeAt=(i,j,nm)=>{E[i]={name:nm,from:E[i].from,to:E[j].to,pts:E[i].pts.concat(E[j].pts.slice(1))};E.splice(j,1)}
    const m=lef.length-1; if(E[m].name.replace(/_l$/,'')===E[m+1].name.replace(/_r$/,''))mergeAt(m,m+1,E[m].name.replace(/_l$/,''))
    const z=E.length-1; if(E[z].name.replace(/_r$/,'')===E[0].name.replace(/_l$/,'')){const nm=E[0].name.replace(/_l$/,'');E[0]={name:nm,from:E[z].from,to:E[0].to,pts:E[z].pts.concat(E[0].pts.slice(1))};E.splice(z,1)}
  }
  // outline + index ranges
  const pts=[],edges=[]
  for(const e of E){ const i0=pts.length; for(let k=0;k<e.pts.length-1;k++)pts.push(e.pts[k].map(r2)); edges.push({name:e.name,from:e.from,to:e.to,first:i0,last:i0+e.pts.length-1,length_mm:r2(len(e.pts))}) }
  for(const e of edges)e.last%=pts.length
  let A=0;for(let i=0;i<pts.length;i++){const a=pts[i],b=pts[(i+1)%pts.length];A+=a[0]*b[1]-b[0]*a[1]} A/=2
  if(A<0){ // reverse to CCW
    const n=pts.length; pts.reverse(); const map=i=>n-1-i
    for(const e of edges){const f=map(e.first),l=map(e.last);e.first=l;e.last=f;const t=e.from;e.from=e.to;e.to=t} edges.reverse() }
  // gaps?
  for(let i=0;i<edges.length;i++)if(edges[i].last!==edges[(i+1)%edges.length].first)throw new Error(`${name}: gap after ${edges[i].name}`)
  return {name,...info,area_mm2:Math.round(Math.abs(A)),points:pts,edges}
}
const SRC=(pkg,m)=>({package:pkg,version:JSON.parse(fs.readFileSync(`node_modules/${pkg}/package.json`)).version,license:'MIT',measurements_set:m})
function meas(D,M){const o={};const p=new D({measurements:M});p.draft();for(const k of p.config.measurements)o[k]=M[k];return o}
const M={...models.cisFemaleAdult34,biceps:330}, set="cisFemaleAdult34 (neck 340 mm), biceps 330 mm to fit the mannequin"
const S=(a,b,c,d,note)=>({a:[a,b],b:[c,d],...(note?{note}:{})})
function run(D,opt){const p=new D({measurements:M,complete:false,sa:0,paperless:false,...(opt?{options:opt}:{})});p.draft();for(const l of p.setStores[0].logs.error||[])console.log('ERR',l);return p}
const out={}
{ // T-shirt
  const p=run(Teagan),P=p.parts[0]
  const body=(nm,side)=>piece(nm,P['teagan.'+nm],P['teagan.'+nm].paths.seam,['cfHem','cfNeck','cbNeck'],
    [['hem','cfHem','hem'],['side','hem','armhole'],['armhole','armhole','shoulder'],['shoulder','shoulder','neck'],['neck','neck',nm==='front'?'cfNeck':'cbNeck'],['fold',nm==='front'?'cfNeck':'cbNeck','cfHem']],true,{cut:1,cut_on_fold:true,place:side})
  const front=body('front','front'),back=body('back','back')
  // sleeve: split the cap where the shoulder seam lands: arc length = back armhole from the back (left) side
  const sp=P['teagan.sleeve'],seam=sp.paths.seam
  const fa=front.edges.find(e=>e.name==='armhole_l').length_mm, ba=back.edges.find(e=>e.name==='armhole_l').length_mm
  let sl=piece('sleeve',sp,seam,['hemLeft','hemRight','bicepsLeft','bicepsRight'],[['hem','hemLeft','hemRight'],['under_front','hemRight','bicepsRight'],['cap','bicepsRight','bicepsLeft'],['under_back','bicepsLeft','hemLeft']],false,{cut:2,mirror_second:true,place:'sleeve',note:'x>0 is the front of the arm'})
  // split cap
  const ci=sl.edges.findIndex(e=>e.name==='cap'),c=sl.edges[ci];const n=sl.points.length;const idx=[];for(let i=c.first;;i=(i+1)%n){idx.push(i);if(i===c.last)break}
  const fromFront=c.from==='bicepsRight'; const target=c.length_mm*(fromFront?fa:ba)/(fa+ba)
  let L=0,bi=0,best=1e9;for(let k=1;k<idx.length;k++){const a=sl.points[idx[k-1]],b=sl.points[idx[k]];L+=Math.hypot(a[0]-b[0],a[1]-b[1]);if(Math.abs(L-target)<best){best=Math.abs(L-target);bi=k}}
  const L2=idx.slice(0,bi+1).map(i=>sl.points[i]),L3=idx.slice(bi).map(i=>sl.points[i])
  const e1={name:fromFront?'cap_front':'cap_back',from:c.from,to:'capTop',first:c.first,last:idx[bi],length_mm:r2(len(L2))},e2={name:fromFront?'cap_back':'cap_front',from:'capTop',to:c.to,first:idx[bi],last:c.last,length_mm:r2(len(L3))}
  sl.edges.splice(ci,1,e1,e2)
  out['tshirt']={format:'yarncloth-pattern',version:1,units:'mm',y_axis:'up',garment:'T-shirt',conventions:'x>0 is the wearer\'s left on every body piece (the back is seen through the body); edges run counter-clockwise; first/last are point indices; a mirrored piece keeps edge names but its edges run the other way',source:SRC('@freesewing/teagan',set),measurements:meas(Teagan,M),
   pieces:[front,back,{...sl,name:'sleeve_l'},{...sl,name:'sleeve_r',cut:1,mirror_of:'sleeve_l',points:undefined,edges:undefined,area_mm2:undefined,note:'x -> -x of sleeve_l, edge names kept, point order reversed'}],
   seams:[S('front','side_l','back','side_l'),S('front','side_r','back','side_r'),S('front','shoulder_l','back','shoulder_l'),S('front','shoulder_r','back','shoulder_r'),
    ...['l','r'].flatMap(s=>[S('front','armhole_'+s,'sleeve_'+s,'cap_front'),S('back','armhole_'+s,'sleeve_'+s,'cap_back'),S('sleeve_'+s,'under_front','sleeve_'+s,'under_back')])]}
}
{ // tank top
  const p=run(Aaron),P=p.parts[0]
  const body=(nm)=>piece(nm,P['aaron.'+nm],P['aaron.'+nm].paths.seam,['cfHem','cfNeck','cbNeck'],
    [['hem','cfHem','hem'],['side','hem','armhole'],['armhole','armhole','strapRight'],['shoulder','strapRight','strapLeft'],['neck','strapLeft',nm==='front'?'cfNeck':'cbNeck'],['fold',nm==='front'?'cfNeck':'cbNeck','cfHem']],true,{cut:1,cut_on_fold:true,place:nm})
  out['tanktop']={format:'yarncloth-pattern',version:1,units:'mm',y_axis:'up',garment:'tank top',source:SRC('@freesewing/aaron',set),measurements:meas(Aaron,M),pieces:[body('front'),body('back')],
   seams:[S('front','side_l','back','side_l'),S('front','side_r','back','side_r'),S('front','shoulder_l','back','shoulder_l'),S('front','shoulder_r','back','shoulder_r')]}
}
{ // skirt
  const p=run(Penelope,{backVent:false,zipperLocation:'sideSeam'}),P=p.parts[0]
  const W=['lWaist','lHem','rHem','rWaist']
  const sk=nm=>{const part=P['penelope.'+nm];const has=k=>part.paths.seam.ops.some(o=>o.to&&part.points[k]&&Math.abs(o.to.x-part.points[k].x)<.02&&Math.abs(o.to.y-part.points[k].y)<.02)
    const g=[['fold','lWaist','lHem'],['hem','lHem','rHem'],['side','rHem','rWaist']]
    if(has('dart2End'))g.push(['waist_c','rWaist','dart2End'],['dart2_b','dart2End','dart2Middle'],['dart2_a','dart2Middle','dart2Start'],['waist_b','dart2Start','dart1End'],['dart1_b','dart1End','dart1Middle'],['dart1_a','dart1Middle','dart1Start'],['waist_a','dart1Start','lWaist'])
    else g.push(['waist_a','rWaist','lWaist'])
    return piece(nm,part,part.paths.seam,['lWaist','lHem','rHem','rWaist'],g,true,{cut:1,cut_on_fold:true,place:nm})}
  const front=sk('front'),back=sk('back')
  const dartSeams=[];for(const q of ['front','back'])for(const s of ['l','r'])for(const d of [1,2])dartSeams.push(S(q,`dart${d}_a_${s}`,q,`dart${d}_b_${s}`,'dart'))
  const wb=piece('waistband',P['penelope.waistband'],P['penelope.waistband'].paths.outline,['TL','BL','BR','TR'],[['long_a','TL','BL'],['end_a','BL','BR'],['long_b','BR','TR'],['end_b','TR','TL']],false,{cut:1,place:'waist'})
  out['skirt']={format:'yarncloth-pattern',version:1,units:'mm',y_axis:'up',garment:'pencil skirt (no vent)',source:SRC('@freesewing/penelope',set),measurements:meas(Penelope,M),pieces:[front,back,wb],seams:[S('front','side_l','back','side_l'),S('front','side_r','back','side_r'),...dartSeams],notes:'waistband long_a goes round the waist opening and is folded in half along its length; leave it out in first tests'}
}
{ // half circle skirt: one 180 degree ring sector cut on the fold (fold = centre front), one seam at centre back
  const p=run(Sandy),part=p.parts[0]['sandy.skirt']
  const pt=part.points, cx=pt.in2Flipped.x, cy=pt.in2.y
  const seen=new Set(); const mv=q=>{if(q&&!seen.has(q)){seen.add(q);q.x-=cx;q.y-=cy}}
  for(const q of Object.values(pt))mv(q); for(const o of part.paths.seam.ops){mv(o.to);mv(o.cp1);mv(o.cp2)}
  // after the shift the fold runs along x=0 from in2Flipped (waist) to ex2Flipped (hem)
  const q=piece('skirt',part,part.paths.seam,['ex2Flipped','ex2','in2','in2Flipped'],[['hem','ex2Flipped','ex2'],['back','ex2','in2'],['waist','in2','in2Flipped'],['fold','in2Flipped','ex2Flipped']],true,{cut:1,cut_on_fold:true,place:'ring',note:'ring sector round the origin: wrap it round the waist; half circle'})
  out['circleskirt']={format:'yarncloth-pattern',version:1,units:'mm',y_axis:'up',garment:'half circle skirt',source:SRC('@freesewing/sandy',set),measurements:meas(Sandy,M),pieces:[q],seams:[S('skirt','back_l','skirt','back_r')]}
}
// direction of a seam: reverse=true when the first point of edge a meets the last point of edge b (edges run counter-clockwise)
const CANON={armhole:'underarm',bicepsRight:'underarm',bicepsLeft:'underarm',shoulder:'top',capTop:'top',hemRight:'hem',hemLeft:'hem',dart1Start:'d1',dart1End:'d1',dart2Start:'d2',dart2End:'d2',rHem:'hem'}
for(const v of Object.values(out))for(const s of v.seams){
  const E=([p,e])=>{let q=v.pieces.find(x=>x.name===p);const mir=!!q.mirror_of;if(mir)q=v.pieces.find(x=>x.name===q.mirror_of);const r=q.edges.find(x=>x.name===e);const c=n=>{n=n.replace(/_m$/,'');return CANON[n]||n};return mir?[c(r.to),c(r.from)]:[c(r.from),c(r.to)]}
  const a=E(s.a),b=E(s.b)
  if(a[0]===b[0]&&a[1]===b[1])s.reverse=false; else if(a[0]===b[1]&&a[1]===b[0])s.reverse=true; else throw new Error('seam direction? '+JSON.stringify([s,a,b]))
}
for(const [k,v] of Object.entries(out)){
  const js=JSON.stringify(v).replace(/"pieces":\[/,'"pieces":[\n').replace(/\},\{"name"/g,'},\n{"name"').replace(/"seams":/,'\n"seams":').replace(/\},\{"a"/g,'},\n {"a"')
  fs.writeFileSync(`out/${k}.json`,js+'\n')
  console.log('==',k,js.length,'bytes')
  for(const q of v.pieces){ if(!q.points){console.log('  ',q.name,'mirror of',q.mirror_of);continue}
    const xs=q.points.map(a=>a[0]),ys=q.points.map(a=>a[1]);console.log('  ',q.name,q.points.length,'pts',`bbox ${r2(Math.max(...xs)-Math.min(...xs))} x ${r2(Math.max(...ys)-Math.min(...ys))} mm`,'edges',q.edges.map(e=>`${e.name}:${e.length_mm}`).join(' '))}
  const E=(p,e)=>{let q=v.pieces.find(x=>x.name===p);if(q.mirror_of)q=v.pieces.find(x=>x.name===q.mirror_of);const r=q.edges.find(x=>x.name===e);if(!r)throw new Error(`${k}: ${p}.${e}`);return r.length_mm}
  for(const s of v.seams){const a=E(...s.a),b=E(...s.b);console.log('   seam',s.a.join('.'),a,s.b.join('.'),b,'ease',(100*(a-b)/b).toFixed(2)+'%')}
}
